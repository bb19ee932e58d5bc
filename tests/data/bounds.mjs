// Writes bounds.json: how many triangles three.js makes of every scene file, and what box they fill, for the test `import`.
//
//   npm install three@0.187.0
//   node bounds.mjs FOLDER_OF_SCENES > bounds.json
//
// Left out are files that three.js cannot read without a browser (Draco), that it draws otherwise (more than one scene, animations and skins,
// whose rest pose differs from the first moment), and those that are not sound.
import fs from 'node:fs';
import path from 'node:path';
import * as THREE from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { MeshoptDecoder } from 'three/addons/libs/meshopt_decoder.module.js';
import { read } from './gltf.mjs';

console.warn = () => {};

const folder = process.argv[2];

// glTF demands rotations of unit length. Some files have them to a few digits only, and three.js takes them as they are.
function normalize(json) {
  for (const node of json.nodes ?? []) {
    if (node.rotation) node.rotation = node.rotation.map((x) => x / Math.hypot(...node.rotation));
  }
  return json;
}

const isReadable = (json) => (json.asset.minVersion ?? '2.0') === '2.0';
const isStill = (json) => !json.animations?.length && !json.skins?.length && (json.scenes?.length ?? 0) === 1;

async function facts(json) {
  const loader = new GLTFLoader().setMeshoptDecoder(MeshoptDecoder);
  const gltf = await loader.parseAsync(JSON.stringify(json), '');
  gltf.scene.updateMatrixWorld(true);
  const box = new THREE.Box3();
  const point = new THREE.Vector3();
  const matrix = new THREE.Matrix4();
  let triangles = 0;
  gltf.scene.traverse((object) => {
    if (!object.isMesh) return;
    const { index, attributes } = object.geometry;
    const corners = index?.count ?? attributes.position.count;
    const copies = object.isInstancedMesh ? object.count : 1;
    triangles += copies * Math.floor(corners / 3);
    for (let copy = 0; copy < copies; copy++) {
      matrix.copy(object.matrixWorld);
      if (object.isInstancedMesh) {
        const instance = new THREE.Matrix4();
        object.getMatrixAt(copy, instance);
        matrix.multiply(instance);
      }
      for (let corner = 0; corner < 3 * Math.floor(corners / 3); corner++) {
        object.getVertexPosition(index ? index.getX(corner) : corner, point);
        box.expandByPoint(point.applyMatrix4(matrix));
      }
    }
  });
  const round = (number) => Number(number.toPrecision(9));
  return { triangles, min: box.min.toArray().map(round), max: box.max.toArray().map(round) };
}

const files = fs.readdirSync(folder, { recursive: true }).map((file) => file.split(path.sep).join('/'));
const results = {};
for (const file of files.filter((file) => /\.gl(tf|b)$/.test(file) && !file.startsWith('invalid/')).sort()) {
  try {
    const json = normalize(read(path.join(folder, file)));
    if (!isReadable(json) || !isStill(json)) continue;
    const found = await facts(json);
    if (found.triangles > 0) results[file] = found;
  } catch (error) {
    console.error(`${file}: ${error.message}`);
  }
}
const lines = Object.entries(results).map(([file, found]) => `${JSON.stringify(file)}: ${JSON.stringify(found)}`);
console.log(`{\n${lines.join(',\n')}\n}`);
