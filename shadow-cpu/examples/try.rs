use shadow_cpu::*; use shadow_scene::*; use shadow_math::*;
fn main(){
 let path=std::env::args().nth(1).unwrap();
 let t=std::time::Instant::now();
 let scene=import(path.as_ref()).unwrap(); println!("import {:?} {} tris {:?}",t.elapsed(),scene.triangles().len(), scene.notes());
 let cam=scene.cameras()[0].camera;
 let plan=FramePlan::new(&scene,&cam,&ShadowSettings::default(),1920,1080,None).unwrap();
 let r=CpuRenderer::new(0,RasterRules::default()).unwrap();
 let p=r.prepare(&scene);
 let mut last=None;
 for _ in 0..4 { let o=r.render(&p,&plan,Request::COLOR).unwrap(); println!("{:?} {:.1}",o.times,o.times.frame()); last=Some(o);}
 let f=last.unwrap().frame; let c=f.color().unwrap();
 let mut img=Vec::new(); for p in c { let e=shadow_math::srgb::encode_pixel((*p).into()); img.extend_from_slice(&e[..3]); }
 std::fs::write("/tmp/out.ppm",[format!("P6\n1920 1080\n255\n").as_bytes(),&img].concat()).unwrap();
}
