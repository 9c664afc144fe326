// Fails on every error and warning of the Khronos glTF validator.
//   node validate.mjs [--of HEAD.glb] FILE.glb...
// With --of: messages of kinds that the head came with are the head's own.
import {readFile} from 'node:fs/promises';
import validator from 'gltf-validator';

// Pictures are the input's own: one that it names and lacks stays named, and the validator does not know KTX2
// (KHR_texture_basisu).
function isTheInputs({code, pointer, message}) {
  if (!/^\/images\/\d+/.test(pointer ?? '')) return false;
  return code === 'IO_ERROR' || code === 'IMAGE_UNRECOGNIZED_FORMAT' || (code === 'VALUE_NOT_IN_LIST' && message.includes('image/ktx2'));
}

async function seriousOf(path) {
  const report = await validator.validateBytes(new Uint8Array(await readFile(path)), {maxIssues: 10000});
  return report.issues.messages.filter((message) => message.severity <= 1 && !isTheInputs(message));
}

let files = process.argv.slice(2);
const own = new Set();
if (files[0] === '--of') {
  for (const message of await seriousOf(files[1])) own.add(message.code);
  if (own.size) console.log(`${files[1]} itself has ${[...own].join(', ')}`);
  files = files.slice(2);
}
let bad = 0;
for (const path of files) {
  const serious = (await seriousOf(path)).filter((message) => !own.has(message.code));
  console.log(`${path}: ${serious.length} errors and warnings`);
  for (const message of serious.slice(0, 20)) console.log(`  ${message.code} ${message.pointer}: ${message.message}`);
  bad += serious.length;
}
process.exit(bad ? 1 : 0);
