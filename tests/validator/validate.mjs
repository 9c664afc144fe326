// Fails on every error and warning of the Khronos glTF validator.
import {readFile} from 'node:fs/promises';
import validator from 'gltf-validator';

// Pictures are the input's own: one that it names and lacks stays named, and the validator does not know KTX2
// (KHR_texture_basisu).
function isTheInputs({code, pointer, message}) {
  if (!/^\/images\/\d+/.test(pointer ?? '')) return false;
  return code === 'IO_ERROR' || code === 'IMAGE_UNRECOGNIZED_FORMAT' || (code === 'VALUE_NOT_IN_LIST' && message.includes('image/ktx2'));
}

let bad = 0;
for (const path of process.argv.slice(2)) {
  const report = await validator.validateBytes(new Uint8Array(await readFile(path)), {maxIssues: 1000});
  const serious = report.issues.messages.filter((message) => message.severity <= 1 && !isTheInputs(message));
  console.log(`${path}: ${serious.length} errors and warnings`);
  for (const message of serious.slice(0, 20)) console.log(`  ${message.code} ${message.pointer}: ${message.message}`);
  bad += serious.length;
}
process.exit(bad ? 1 : 0);
