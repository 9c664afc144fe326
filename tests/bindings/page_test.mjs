// samples/web in headless Chromium: page_test.mjs RIG.glb PICTURE.png. The head is shown, moves, and the console is empty.
import assert from 'node:assert/strict';
import {spawn} from 'node:child_process';
import {mkdtempSync, readFileSync, writeFileSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {dirname, join} from 'node:path';
import {fileURLToPath} from 'node:url';

const [rig, picture] = process.argv.slice(2);
const sample = join(dirname(fileURLToPath(import.meta.url)), '../../samples/web');
const server = spawn('node', ['serve.mjs', rig], {cwd: sample, env: {...process.env, PORT: '0'}, stdio: ['ignore', 'pipe', 'inherit']});
const address = await new Promise((found) => server.stdout.on('data', (text) => {
  const url = /http:\/\/\S+/.exec(text);
  if (url) found(url[0]);
}));
const browser = spawn('chromium', ['--headless=new', '--no-sandbox', '--disable-gpu', '--use-gl=angle', '--use-angle=swiftshader',
  '--enable-unsafe-swiftshader', '--window-size=1100,800', '--remote-debugging-port=0',
  `--user-data-dir=${mkdtempSync(join(tmpdir(), 'fascia-'))}`, 'about:blank'], {stdio: ['ignore', 'ignore', 'pipe']});
let code = 1;
try {
  const devtools = await new Promise((found) => browser.stderr.on('data', (text) => {
    const url = /ws:\/\/\S+/.exec(text);
    if (url) found(url[0]);
  }));
  const targets = await (await fetch(`http://${new URL(devtools).host}/json`)).json();
  const socket = new WebSocket(targets.find(({type}) => type === 'page').webSocketDebuggerUrl);
  await new Promise((open) => socket.addEventListener('open', open));
  const answers = new Map(), complaints = [];
  let last = 0;
  socket.addEventListener('message', ({data}) => {
    const message = JSON.parse(data);
    answers.get(message.id)?.(message);
    if (message.method === 'Runtime.exceptionThrown') complaints.push(message.params.exceptionDetails.exception?.description ?? 'exception');
    if (message.method === 'Log.entryAdded' && message.params.entry.level !== 'info' && !/GPU stall|GL Driver/.test(message.params.entry.text))
      complaints.push(`${message.params.entry.text} ${message.params.entry.url ?? ""}`.trim());
    if (message.method === 'Runtime.consoleAPICalled' && ['error', 'warning', 'assert'].includes(message.params.type))
      complaints.push(message.params.args.map(({value}) => value).join(' '));
  });
  const send = (method, params = {}) => new Promise((answer) => {
    answers.set(++last, answer);
    socket.send(JSON.stringify({id: last, method, params}));
  });
  const ask = async (expression) => {
    const {result} = await send('Runtime.evaluate', {expression, awaitPromise: true, returnByValue: true});
    if (result.exceptionDetails) throw new Error(result.exceptionDetails.exception?.description ?? expression);
    return result.result.value;
  };
  const until = async (expression) => {
    for (let i = 0; i < 720; ++i) {
      if (await ask(expression)) return;
      await new Promise((later) => setTimeout(later, 250));
    }
    throw new Error(`in vain: ${expression}; ${complaints.join('; ')}`);
  };
  await send('Runtime.enable');
  await send('Log.enable');
  await send('Page.enable');
  await send('Page.navigate', {url: address});
  await until('window.fascia?.face != null');
  const rest = await ask('Array.from(fascia.face.face.positions(0))');
  const sliders = await ask('document.querySelectorAll("#sliders label").length');
  assert.ok(sliders > 2, `${sliders} sliders`);
  // A slider as a user moves it, then the capture.
  await ask(`(() => { for (const label of document.querySelectorAll('#sliders label')) if (/smile/.test(label.dataset.name)) {
    const input = label.querySelector('input'); input.value = 0.9; input.dispatchEvent(new Event('input')); } })()`);
  await until(`fascia.face.parts.some(({index}) => fascia.face.asset.meshes[index].part === 'skin') &&
               fascia.face.face.effectiveValues.some((value) => value > 0.3)`);
  await new Promise((later) => setTimeout(later, 2500));
  const {result} = await send('Page.captureScreenshot', {format: 'png'});
  writeFileSync(picture, Buffer.from(result.data, 'base64'));
  assert.notDeepEqual(await ask('Array.from(fascia.face.face.effectiveValues)'), await ask('fascia.face.asset.channels.map(({rest}) => rest)'));
  await ask('document.getElementById("rest").click()');
  await ask('document.getElementById("replay").click()');
  await until('fascia.face.takes.length === 1 && fascia.face.takes[0].time > 0.2');
  const cost = await ask('document.getElementById("status").textContent');
  assert.deepEqual(complaints, []);
  assert.equal(rest.length % 3, 0);
  assert.ok(readFileSync(picture).length > 20000, 'the picture is empty');
  console.log(`web page: ${sliders} sliders, ${cost}, the console is empty, all passed`);
  code = 0;
} catch (error) {
  console.error(error);
} finally {
  server.kill();
  browser.kill();
  process.exit(code);
}
