// Headless Chromium, driven through the DevTools protocol over a pipe. Nothing here waits without a limit.
import {spawn} from 'node:child_process';
import {mkdtempSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';

const patience = Number(process.env.FASCIA_PATIENCE ?? 1);
const ignored = /GPU stall|GL Driver/;  // what the software renderer says about itself

/** `promise`, or an error that names `what` after so many seconds (times FASCIA_PATIENCE). */
export function within(promise, seconds, what) {
  let timer;
  const limit = new Promise((_, fail) => {
    timer = setTimeout(() => fail(new Error(`${what}: no answer in ${seconds * patience} s`)), 1000 * seconds * patience);
  });
  return Promise.race([promise, limit]).finally(() => clearTimeout(timer));
}

/** A child in a process group of its own. `ended` rejects when it ends, with the last it wrote to stderr. */
export class Child {
  constructor(name, command, options, stdio) {
    this.process = spawn(name, command, {...options, stdio, detached: true});
    this.said = '';
    this.process.stderr?.on('data', (text) => { this.said = (this.said + text).slice(-2048); });
    this.ended = new Promise((_, fail) => {
      this.process.on('error', fail);
      this.process.on('exit', (code, signal) => fail(new Error(`${name} ended (${signal ?? code}): ${this.said}`)));
    });
    this.ended.catch(() => {});
  }
  /** The first match of `pattern` in what it writes to stdout. */
  line(pattern, seconds, what) {
    let text = '';
    const found = new Promise((take) => this.process.stdout.on('data', (more) => {
      text += more;
      const match = pattern.exec(text);
      if (match) take(match);
    }));
    return within(Promise.race([found, this.ended]), seconds, what);
  }
  kill() {
    try {
      process.kill(-this.process.pid, 'SIGKILL');
    } catch {
      // gone already
    }
  }
}

/** A browser with one page. What the page logs as a warning or an error, or throws, is in `complaints`. */
export class Browser {
  static async launch({width = 900, height = 620, gpu = false} = {}) {
    const browser = new Browser(width, height, gpu);
    try {
      await browser.attach();
    } catch (error) {
      browser.close();
      throw error;
    }
    return browser;
  }

  constructor(width, height, gpu) {
    this.profile = mkdtempSync(join(tmpdir(), 'fascia-'));
    this.child = new Child('chromium', ['--headless=new', '--no-sandbox', ...(gpu ? [] : ['--disable-gpu']), '--use-gl=angle',
      '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--disable-dev-shm-usage', '--no-first-run',
      '--disable-extensions', '--disable-background-networking', '--disable-renderer-backgrounding',
      '--disable-background-timer-throttling', '--disable-backgrounding-occluded-windows', '--no-proxy-server',
      ...(process.env.FASCIA_CHROMIUM_FLAGS?.split(' ') ?? []),
      `--window-size=${width},${height}`, '--remote-debugging-pipe', `--user-data-dir=${this.profile}`, 'about:blank'],
                           {}, ['ignore', 'ignore', 'pipe', 'pipe', 'pipe']);
    this.complaints = [];
    this.answers = new Map();
    this.last = 0;
    this.died = new Promise((_, fail) => { this.fail = fail; });
    this.died.catch(() => {});
    this.child.ended.catch(this.fail);
    this.listen();
  }

  /** Messages end in a zero byte. */
  listen() {
    const [, , , to, from] = this.child.process.stdio;
    let rest = Buffer.alloc(0);
    from.on('data', (more) => {
      rest = Buffer.concat([rest, more]);
      for (let end = rest.indexOf(0); end >= 0; end = rest.indexOf(0)) {
        this.take(JSON.parse(rest.subarray(0, end).toString()));
        rest = rest.subarray(end + 1);
      }
    });
    // The pipe may break a moment before the browser's end is known, which says more.
    for (const stream of [to, from])
      stream.on('error', ({message}) => setTimeout(() => this.fail(new Error(`chromium ended its pipe: ${message}`)), 500));
  }

  take({id, method, params, result, error}) {
    if (id !== undefined) {
      const {answer, refuse} = this.answers.get(id) ?? {};
      this.answers.delete(id);
      if (error) refuse?.(new Error(error.message));
      else answer?.(result);
    } else if (method === 'Inspector.targetCrashed' || method === 'Target.targetCrashed') {
      this.fail(new Error(`the page crashed: ${this.child.said}`));
    } else if (method === 'Runtime.exceptionThrown') {
      this.complaints.push(params.exceptionDetails.exception?.description ?? params.exceptionDetails.text);
    } else if (method === 'Log.entryAdded' && params.entry.level !== 'info' && !ignored.test(params.entry.text)) {
      this.complaints.push(`${params.entry.text} ${params.entry.url ?? ''}`.trim());
    } else if (method === 'Runtime.consoleAPICalled' && ['error', 'warning', 'assert'].includes(params.type)) {
      this.complaints.push(params.args.map(({value, description}) => value ?? description).join(' '));
    }
  }

  send(method, params = {}) {
    const id = ++this.last;
    const answered = new Promise((answer, refuse) => this.answers.set(id, {answer, refuse}));
    answered.catch(() => {});
    this.child.process.stdio[3].write(JSON.stringify({id, method, params, sessionId: this.session}) + '\0');
    return within(Promise.race([answered, this.died]), 20, method);
  }

  async attach() {
    const {targetInfos} = await this.send('Target.getTargets');
    const {targetId} = targetInfos.find(({type}) => type === 'page') ??
                       await this.send('Target.createTarget', {url: 'about:blank'});
    this.session = (await this.send('Target.attachToTarget', {targetId, flatten: true})).sessionId;
    for (const domain of ['Inspector', 'Runtime', 'Log', 'Page']) await this.send(`${domain}.enable`);
  }

  /** The value of an expression in the page. */
  async ask(expression) {
    const {result, exceptionDetails} =
        await this.send('Runtime.evaluate', {expression, awaitPromise: true, returnByValue: true});
    if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ?? expression);
    return result.value;
  }

  /** Waits until an expression is true; the first complaint of the page ends the wait. */
  async until(expression, seconds = 60) {
    const end = Date.now() + 1000 * seconds * patience;
    while (!await this.ask(expression)) {
      if (this.complaints.length > 0) throw new Error(`${expression}: the page complains: ${this.complaints.join('; ')}`);
      if (Date.now() > end) throw new Error(`${expression}: in vain for ${seconds * patience} s`);
      await new Promise((later) => setTimeout(later, 100));
    }
  }

  hasWebGL2() { return this.ask('document.createElement("canvas").getContext("webgl2") !== null'); }

  async picture() { return Buffer.from((await this.send('Page.captureScreenshot', {format: 'png'})).data, 'base64'); }

  close() {
    this.child.kill();
    rmSync(this.profile, {recursive: true, force: true, maxRetries: 10, retryDelay: 100});
  }
}

/** A browser that can draw, or null: started once more with the graphics card's process when it cannot without. */
export async function browserWithWebGL2(options = {}) {
  for (const gpu of [false, true]) {
    const browser = await Browser.launch({...options, gpu});
    if (await browser.hasWebGL2()) return browser;
    browser.close();
  }
  return null;
}
