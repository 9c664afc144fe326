// Runs the Khronos validator over GLB files: any error or warning fails.
// usage: NODE_PATH=<where npm put gltf-validator> node gltf_validator.js FILE.glb...
'use strict';
const fs = require('fs');
const validator = require('gltf-validator');

async function main(paths) {
  let bad = 0;
  for (const path of paths) {
    const report = await validator.validateBytes(new Uint8Array(fs.readFileSync(path)), {maxIssues: 0});
    for (const message of report.issues.messages.filter((m) => m.severity <= 1))
      console.error(`${path}: ${message.code} ${message.pointer || ''}: ${message.message}`);
    bad += report.issues.numErrors + report.issues.numWarnings;
    console.log(`${path}: ${report.issues.numErrors} errors, ${report.issues.numWarnings} warnings`);
  }
  process.exit(paths.length === 0 || bad > 0 ? 1 : 0);
}

main(process.argv.slice(2)).catch((error) => {
  console.error(String(error));
  process.exit(1);
});
