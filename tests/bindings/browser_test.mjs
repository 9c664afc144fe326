// browser.mjs itself: waits end at once when the page complains, crashes or the browser ends, and nothing is left behind.
// Exit 77 where Chromium cannot draw.
import assert from 'node:assert/strict';
import {existsSync} from 'node:fs';
import {Browser, Child, browserWithWebGL2, within} from './browser.mjs';

const browsers = [];
const launch = async () => {
  const browser = await Browser.launch();
  browsers.push(browser);
  return browser;
};
/** That `promise` fails with `pattern`, and in how many seconds. */
async function failsSoon(promise, pattern, seconds) {
  const before = Date.now();
  await assert.rejects(promise, pattern);
  const took = (Date.now() - before) / 1000;
  assert.ok(took < seconds, `${pattern} took ${took} s`);
}

let code = 1;
try {
  await failsSoon(within(new Promise(() => {}), 0.2, 'nothing'), /nothing: no answer/, 20);
  const child = new Child('node', ['-e', 'console.error("my last words"); process.exit(3)'], {}, ['ignore', 'pipe', 'pipe']);
  await failsSoon(child.line(/never/, 60, 'a line'), /node ended \(3\)/, 30);
  await failsSoon(new Child('no-such-program', [], {}, ['ignore', 'pipe', 'pipe']).line(/x/, 60, 'a line'), /ENOENT/, 30);

  const drawing = await browserWithWebGL2();
  if (!drawing) {
    console.log('browser: left out, Chromium has no WebGL 2 here');
    process.exit(77);
  }
  browsers.push(drawing);
  await drawing.ask('console.error("a complaint of the page")');
  await failsSoon(drawing.until('false', 60), /a complaint of the page/, 30);

  const crashing = await launch();
  const waiting = failsSoon(crashing.until('false', 60), /crashed|no answer/, 45);
  crashing.send('Page.crash').catch(() => {});
  await waiting;

  const killed = await launch();
  const lost = failsSoon(killed.until('false', 60), /chromium ended|no answer/, 45);
  killed.child.kill();
  await lost;
  for (const browser of browsers) {
    browser.close();
    assert.ok(!existsSync(browser.profile), `${browser.profile} is left`);
  }
  console.log('browser: waits end when the page complains, crashes or the browser ends');
  code = 0;
} catch (error) {
  console.error(error);
}
for (const browser of browsers) browser.close();
process.exit(code);
