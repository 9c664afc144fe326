// samples/web in headless Chromium: page_test.mjs HEAD.glb RIG.glb PLAYED.glb PICTURE.png. HEAD is a whole face, RIG a smaller
// one to drop on the page, PLAYED what `fascia play` made of RIG. The faces are shown and move, and the console stays
// empty. Exit 77 without WebGL 2.
import assert from 'node:assert/strict';
import {readFileSync, writeFileSync} from 'node:fs';
import {dirname, join} from 'node:path';
import {fileURLToPath} from 'node:url';
import {browserWithWebGL2, Child} from './browser.mjs';

const [head, rig, played, picture] = process.argv.slice(2);
const sample = join(dirname(fileURLToPath(import.meta.url)), '../../samples/web');
const open = [];  // to be closed whatever happens
for (const signal of ['SIGTERM', 'SIGINT']) process.on(signal, () => end(1));
let code = 1;
try {
  code = await test();
} catch (error) {
  console.error(error);
}
end(code);

function end(status) {
  for (const each of open) each();
  process.exit(status);
}

async function test() {
  const server = new Child('node', ['serve.mjs', head], {cwd: sample, env: {...process.env, PORT: '0'}}, ['ignore', 'pipe', 'pipe']);
  open.push(() => server.kill());
  const [address] = await server.line(/http:\/\/\S+(?=\s)/, 20, 'the server');
  const browser = await browserWithWebGL2();
  if (!browser) {
    console.log('web page: left out, Chromium has no WebGL 2 here');
    return 77;
  }
  open.push(() => browser.close());
  await browser.send('Page.navigate', {url: address});
  await browser.until('window.fascia?.face != null');
  const sliders = await moveASlider(browser);
  const image = await browser.picture();
  writeFileSync(picture, image);
  assert.ok(image.length > 20000, 'the picture is empty');
  await replayTheCapture(browser);
  const cost = await browser.ask('document.getElementById("status").textContent');
  await dropARig(browser);
  const moved = await playTheAnimation(browser);
  assert.deepEqual(browser.complaints, []);
  console.log(`web page: ${sliders} sliders, ${cost}, a dropped rig played by its animation up to ${moved.toFixed(4)}, the console is empty`);
  return 0;
}

/** Keeps the positions of all parts as window.kept; window.moved() is how far the farthest coordinate is from them now. */
async function keepPositions(browser) {
  await browser.ask(`(() => {
    const all = () => fascia.face.parts.map(({index}) => Array.from(fascia.face.face.positions(index))).flat();
    window.kept = all();
    window.moved = () => { const now = all(); return now.reduce((most, x, i) => Math.max(most, Math.abs(x - kept[i])), 0); };
  })()`);
}

/** A slider as a user moves it. */
async function moveASlider(browser) {
  await keepPositions(browser);
  const sliders = await browser.ask('document.querySelectorAll("#sliders label").length');
  assert.ok(sliders > 2, `${sliders} sliders`);
  const found = await browser.ask(`(() => {
    const smiles = [...document.querySelectorAll('#sliders label')].filter(({dataset}) => /smile/.test(dataset.name));
    for (const label of smiles) {
      const input = label.querySelector('input');
      input.value = 0.9;
      input.dispatchEvent(new Event('input'));
    }
    return smiles.length;
  })()`);
  assert.ok(found >= 1, 'no slider of a smile');
  await browser.until('fascia.face.face.effectiveValues.some((value) => value > 0.3) && moved() > 0');
  // Until the smile is complete: the skin stands still from one frame to the next.
  await browser.until(`new Promise((next) => {
    const before = moved();
    requestAnimationFrame(() => requestAnimationFrame(() => next(Math.abs(moved() - before) < 1e-3 * moved())));
  })`);
  return sliders;
}

async function replayTheCapture(browser) {
  await browser.ask('document.getElementById("rest").click()');
  await keepPositions(browser);
  await browser.ask('document.getElementById("replay").click()');
  await browser.until('fascia.face.takes.length === 1 && fascia.face.takes[0].time > 0.2 && moved() > 0');
}

/** The bytes of a file as an expression of the page. */
function bytesOf(path) {
  return `Uint8Array.from(atob('${readFileSync(path).toString('base64')}'), (c) => c.charCodeAt(0))`;
}

async function dropARig(browser) {
  await browser.ask(`(() => {
    window.before = fascia.face;
    const dropped = new DataTransfer();
    dropped.items.add(new File([${bytesOf(rig)}], 'dropped.glb'));
    dispatchEvent(new DragEvent('drop', {dataTransfer: dropped, bubbles: true, cancelable: true}));
  })()`);
  await browser.until('fascia.face !== before');
  assert.notEqual(await browser.ask('fascia.face.asset.meshes.length'), 0);
  assert.equal(await browser.ask('fascia.face.takes.length'), 0);
}

/** What `fascia play` wrote carries its curves as an animation: loaded and played, they move the dropped face. */
async function playTheAnimation(browser) {
  await keepPositions(browser);
  await browser.ask(`fascia.replay(${bytesOf(played)})`);
  await browser.until('fascia.face.takes.length === 1 && fascia.face.takes[0].curves.names.length > 0 && moved() > 0');
  await browser.ask('window.most = 0');
  const end = 'fascia.face.takes[0].time > 0.5 * fascia.face.takes[0].curves.duration';
  await browser.until(`(window.most = Math.max(most, moved())) > 1e-4 && ${end}`);
  return browser.ask('most');
}
