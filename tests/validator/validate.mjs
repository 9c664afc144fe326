// Fails on every error and warning of the Khronos glTF validator.
import {readFile} from 'node:fs/promises';
import validator from 'gltf-validator';

let bad = 0;
for (const path of process.argv.slice(2)) {
  const report = await validator.validateBytes(new Uint8Array(await readFile(path)), {maxIssues: 1000});
  const serious = report.issues.messages.filter((message) => message.severity <= 1);
  console.log(`${path}: ${report.issues.numErrors} errors, ${report.issues.numWarnings} warnings`);
  for (const message of serious.slice(0, 20)) console.log(`  ${message.code} ${message.pointer}: ${message.message}`);
  bad += serious.length;
}
process.exit(bad ? 1 : 0);
