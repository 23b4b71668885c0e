// node validate_gltf.cjs MODULES FILE TRIANGLES VERTICES ...: Khronos' validator on each file. Errors, warnings and
// counts other than those given are printed and fail; "-" stands for any count.
const fs = require("fs");
const path = require("path");
const validator = require(path.join(path.resolve(process.argv[2]), "gltf-validator"));

async function main() {
  let bad = 0;
  for (let i = 3; i + 2 < process.argv.length; i += 3) {
    const [file, triangles, vertices] = process.argv.slice(i, i + 3);
    const report = await validator.validateBytes(new Uint8Array(fs.readFileSync(file)), { maxIssues: 20 });
    const complain = (text) => {
      console.error(`gltf-validator: ${file}: ${text}`);
      ++bad;
    };
    for (const issue of report.issues.messages)
      if (issue.severity < 2) complain(`${issue.code} at ${issue.pointer}: ${issue.message}`);
    if (triangles !== "-" && report.info.totalTriangleCount !== Number(triangles))
      complain(`${report.info.totalTriangleCount} triangles, expected ${triangles}`);
    if (vertices !== "-" && report.info.totalVertexCount !== Number(vertices))
      complain(`${report.info.totalVertexCount} vertices, expected ${vertices}`);
  }
  process.exit(bad ? 1 : 0);
}

main();
