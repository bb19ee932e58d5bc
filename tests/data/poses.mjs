// Writes poses.json: what three.js makes of animated and skinned files, for the test `poses`.
//
//   npm install three@0.187.0
//   node poses.mjs FOLDER_OF_SCENES > poses.json
//
// three.js interpolates, places nodes and skins vertices with code of its own, in double precision but for the interpolated
// numbers themselves, which it rounds to single precision.
import path from 'node:path';
import * as THREE from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { read } from './gltf.mjs';

// File, number of the animation, times in seconds: on keys, between them, and beyond the end.
const CASES = [
  ['fox/Fox.glb', 0, [0, 1.7]],
  ['fox/Fox.glb', 2, [0.4]],
  ['cesium_man/CesiumMan.glb', 0, [0, 0.77]],
  ['kaykit_knight/knight.glb', 1, [0.3]],
  ['godot_robot_player/player.glb', 4, [0.35]],
  ['features/RiggedSimple/RiggedSimple.glb', 0, [1.3]],
  ['features/SimpleSkin/SimpleSkin.gltf', 0, [0, 1.25, 4.2]],
  ['features/blender_03_skinned_cylinder/03_skinned_cylinder.gltf', 0, [0.6]],
  ['features/AnimatedMorphCube/AnimatedMorphCube.glb', 0, [0.9, 3.1]],
  ['features/AnimatedMorphCube/AnimatedMorphCubeQuantized.gltf', 0, [0.9]],
  ...[0, 1, 2, 3, 4, 5, 6, 7, 8].map((n) => ['features/InterpolationTest/InterpolationTest.glb', n, [0.3, 1.1, 99]]),
  ['asset_generator/Animation_Node/Animation_Node_00.gltf', 0, [0.7]],
  ['asset_generator/Animation_Node/Animation_Node_02.gltf', 0, [0.7]],
  ['asset_generator/Animation_Node/Animation_Node_04.gltf', 0, [0.7, 2.6]],
  ['asset_generator/Animation_NodeMisc/Animation_NodeMisc_00.gltf', 0, [0.7]],
  ['asset_generator/Animation_NodeMisc/Animation_NodeMisc_04.gltf', 0, [0.7]],
  ['asset_generator/Animation_NodeMisc/Animation_NodeMisc_08.gltf', 0, [0.7, 3.3]],
  ['asset_generator/Animation_SamplerType/Animation_SamplerType_00.gltf', 0, [1.4]],
  ['asset_generator/Animation_SamplerType/Animation_SamplerType_02.gltf', 0, [1.4]],
  ['asset_generator/Animation_Skin/Animation_Skin_04.gltf', 0, [0.8]],
  ['asset_generator/Animation_SkinType/Animation_SkinType_02.gltf', 0, [0.8]],
];

const load = (file) => new GLTFLoader().parseAsync(JSON.stringify(read(file)), '');

// glTF demands rotations of unit length. SimpleSkin has them to 3 digits only, and three.js takes them as they are.
function normalize(track) {
  if (!track.name.endsWith('.quaternion') || track.values.length !== 4 * track.times.length) return;
  for (let i = 0; i < track.values.length; i += 4) {
    new THREE.Quaternion().fromArray(track.values, i).normalize().toArray(track.values, i);
  }
}

const round = (number) => Number(number.toPrecision(9));

function pose(gltf, animation, time) {
  const mixer = new THREE.AnimationMixer(gltf.scene);
  if (gltf.animations[animation] === undefined) throw new Error(`there is no animation ${animation}`);
  const action = mixer.clipAction(gltf.animations[animation]);
  action.setLoop(THREE.LoopOnce);
  action.clampWhenFinished = true;
  action.play();
  mixer.setTime(time);
  gltf.scene.updateMatrixWorld(true);
  const nodes = {};
  const vertices = [];
  let count = 0;
  gltf.scene.traverse((object) => {
    const association = gltf.parser.associations.get(object);
    if (association?.nodes !== undefined && (association.meshes === undefined || association.primitives === undefined || object.isMesh)) {
      const m = object.matrixWorld.elements;
      nodes[association.nodes] ??= [0, 1, 2, 4, 5, 6, 8, 9, 10, 12, 13, 14].map((i) => round(m[i]));
    }
    if (object.isMesh) {
      const inFile = object.geometry.attributes.position.count;
      const isDeformed = object.isSkinnedMesh || object.morphTargetInfluences !== undefined;
      const step = Math.max(1, Math.floor(inFile / 5));
      for (let i = 0; isDeformed && i < inFile; i += step) {
        const point = object.getVertexPosition(i, new THREE.Vector3()).applyMatrix4(object.matrixWorld);
        vertices.push([count + i, ...point.toArray().map(round)]);
      }
      count += inFile;
    }
  });
  mixer.stopAllAction();
  return { animation, time, nodes, count, vertices };
}

const results = [];
for (const [file, animation, times] of CASES) {
  const gltf = await load(path.join(process.argv[2], file));
  for (const clip of gltf.animations) clip.tracks.forEach(normalize);
  for (const time of times) results.push({ file, ...pose(gltf, animation, time) });
}
console.log('[\n' + results.map((result) => JSON.stringify(result)).join(',\n') + '\n]');
