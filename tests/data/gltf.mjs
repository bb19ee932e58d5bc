// What the scripts of this folder read of a glTF file: its JSON without materials, which need a browser, and with all buffers inside.
import fs from 'node:fs';
import path from 'node:path';

globalThis.ProgressEvent ??= class {};

export function read(file) {
  const bytes = fs.readFileSync(file);
  let json;
  let bin;
  if (bytes.toString('latin1', 0, 4) === 'glTF') {
    const length = bytes.readUInt32LE(12);
    json = JSON.parse(bytes.toString('utf8', 20, 20 + length));
    bin = bytes.subarray(28 + length);
  } else {
    json = JSON.parse(bytes.toString('utf8'));
  }
  for (const key of ['materials', 'textures', 'images', 'samplers']) delete json[key];
  for (const mesh of json.meshes ?? []) for (const primitive of mesh.primitives) delete primitive.material;
  for (const buffer of json.buffers ?? []) {
    if (buffer.uri?.startsWith('data:') || (buffer.uri === undefined && bin === undefined)) continue;
    const content = buffer.uri === undefined ? bin : fs.readFileSync(path.join(path.dirname(file), decodeURIComponent(buffer.uri)));
    buffer.uri = 'data:application/octet-stream;base64,' + content.subarray(0, buffer.byteLength).toString('base64');
  }
  return json;
}
