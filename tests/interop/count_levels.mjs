// node count_levels.mjs MODULES FILE LEVELS TRIANGLES ...: loads each file with three's GLTFLoader and counts its meshes named
// NAME_LOD0, NAME_LOD1, ...; TRIANGLES of level 0 and fewer in each further one.
import fs from "fs";
import path from "path";
import { pathToFileURL } from "url";

// Of browsers, and asked for where a buffer stands in the file as text.
globalThis.ProgressEvent ??= class ProgressEvent extends Event {};

const modules = path.resolve(process.argv[2]);
const module = (name) => import(pathToFileURL(path.join(modules, "three", name)).href);
const { GLTFLoader } = await module("examples/jsm/loaders/GLTFLoader.js");

let bad = 0;
for (let i = 3; i + 2 < process.argv.length; i += 3) {
  const [file, levels, triangles] = process.argv.slice(i, i + 3);
  const complain = (text) => {
    console.error(`three: ${file}: ${text}`);
    ++bad;
  };
  const bytes = fs.readFileSync(file);
  const buffer = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);
  const gltf = await new Promise((resolve, reject) => new GLTFLoader().parse(buffer, "", resolve, reject));
  // A level of several materials is a group of meshes.
  const counts = [];
  gltf.scene.traverse((object) => {
    const level = /_LOD(\d+)$/.exec(object.name);
    if (!level) return;
    let count = 0;
    object.traverse((part) => {
      if (part.isMesh) count += part.geometry.index.count / 3;
    });
    counts[Number(level[1])] = count;
  });
  if (counts.length !== Number(levels)) complain(`${counts.length} levels, expected ${levels}`);
  if (counts[0] !== Number(triangles)) complain(`${counts[0]} triangles in level 0, expected ${triangles}`);
  for (let k = 1; k < counts.length; ++k) if (!(counts[k] < counts[k - 1])) complain(`level ${k} has ${counts[k]} triangles`);
}
process.exit(bad ? 1 : 0);
