// Fascia's runtime in JavaScript: the C interface (fascia/fascia.h) as classes, on WebAssembly. Types: index.d.ts.
const combines = {add: 0, max: 1, saturate: 2, override: 3};
const spaces = {mesh: 0, input: 1, metres: 2};

/** What went wrong, in the library's own words. */
export class FasciaError extends Error {}

/** Loads the library; `wasm` is a URL, a Response or the bytes, and beside this file when left out. */
export async function loadFascia({wasm} = {}) {
  const bytes = await bytesOf(wasm ?? new URL('./fascia.wasm', import.meta.url));
  let memory;
  const imports = {  // the little that a library which reads no files asks of its system
    fd_write: (file, list, count, written) => {
      const view = new DataView(memory.buffer);
      let size = 0;
      for (let i = 0; i < count; ++i) size += view.getUint32(list + 8 * i + 4, true);
      view.setUint32(written, size, true);
      return 0;
    },
    proc_exit: (code) => { throw new FasciaError(`the library ended with code ${code}`); },
    environ_sizes_get: (count, size) => {
      const view = new DataView(memory.buffer);
      view.setUint32(count, 0, true);
      view.setUint32(size, 0, true);
      return 0;
    },
    clock_time_get: (clock, precision, time) => {
      new DataView(memory.buffer).setBigUint64(time, BigInt(Math.round(performance.now() * 1e6)), true);
      return 0;
    },
  };
  const ignore = () => 0;
  const any = new Proxy(imports, {get: (known, name) => known[name] ?? ignore, has: () => true});
  const {instance} = await WebAssembly.instantiate(bytes, {wasi_snapshot_preview1: any, env: any});
  memory = instance.exports.memory;
  instance.exports._initialize?.();
  return new Fascia(instance.exports);
}

async function bytesOf(wasm) {
  if (wasm instanceof ArrayBuffer || ArrayBuffer.isView(wasm)) return wasm;
  if (typeof Response !== 'undefined' && wasm instanceof Response) return wasm.arrayBuffer();
  const url = new URL(wasm, import.meta.url);
  if (url.protocol === 'file:') return (await import('node:fs/promises')).readFile(url);
  const response = await fetch(url);
  if (!response.ok) throw new FasciaError(`${url}: ${response.status} ${response.statusText}`);
  return response.arrayBuffer();
}

/** The library: makes assets and curves. */
class Fascia {
  constructor(exports) {
    this.exports = exports;
  }

  /** [major, minor, patch] */
  get version() {
    const packed = this.exports.fascia_version();
    return [packed >>> 16, packed >>> 8 & 255, packed & 255];
  }

  loadAsset(bytes) {
    return new Asset(this, this.withBytes(bytes, (at, size) => this.exports.web_asset_load(at, size)));
  }

  loadCurves(bytes, {framesPerSecond = 0} = {}) {
    const data = typeof bytes === 'string' ? new TextEncoder().encode(bytes) : bytes;
    return new Curves(
        this, this.withBytes(data, (at, size) => this.exports.web_curves_load(at, size, framesPerSecond)));
  }

  // --- for the classes below
  fail() { throw new FasciaError(this.text(this.exports.fascia_last_message())); }
  check(result) { if (result !== 0) this.fail(); }
  bytes(at, count) { return new Uint8Array(this.exports.memory.buffer, at, count); }
  floats(at, count) { return new Float32Array(this.exports.memory.buffer, at, count); }
  words(at, count) { return new Uint32Array(this.exports.memory.buffer, at, count); }
  text(at) {
    const all = new Uint8Array(this.exports.memory.buffer);
    return new TextDecoder().decode(all.slice(at, all.indexOf(0, at)));
  }
  texts(at, count) { return Array.from(this.words(at, count), (text) => this.text(text)); }
  /** Calls `use` with a copy of `bytes` in the library's memory; its result, which must not be 0. */
  withBytes(bytes, use) {
    const list = ArrayBuffer.isView(bytes) ? new Uint8Array(bytes.buffer, bytes.byteOffset, bytes.byteLength)
                                           : new Uint8Array(bytes);
    const at = this.exports.malloc(Math.max(1, list.length));
    if (at === 0) throw new FasciaError('out of memory');
    this.bytes(at, list.length).set(list);
    const result = use(at, list.length);
    this.exports.free(at);
    if (result === 0) this.fail();
    return result;
  }
  withText(text, use) {
    let result = 0;
    this.withBytes(new TextEncoder().encode(text + '\0'), (at) => { result = use(at); return 1; });
    this.check(result);
  }
}

/** The number that stands for a word of an option. */
function chosen(option, words, word) {
  if (Object.hasOwn(words, word)) return words[word];
  throw new FasciaError(`there is no ${option} '${word}': ${Object.keys(words).join(', ')}`);
}

/** `list` as 32-bit floats, exactly `count` of them. */
function numbers(what, list, count) {
  if (list.length !== count) throw new FasciaError(`the ${what} has ${list.length} numbers, not ${count}`);
  return Float32Array.from(list);
}

/** A loaded rig. `dispose` it when no more faces will be made; faces keep what they need. */
class Asset {
  constructor(fascia, handle) {
    this.fascia = fascia;
    this.handle = handle;
    const {exports} = fascia;
    const info = (member) => exports.web_asset_info(handle, member);
    this.inputToMetres = Array.from(fascia.floats(info(4), 16));
    this.levels = Array.from({length: info(0)}, (_, level) => ({
      name: fascia.text(exports.web_asset_level(handle, level, 0)), nodeCount: exports.web_asset_level(handle, level, 1)}));
    this.meshes = Array.from({length: info(1)}, (_, mesh) => {
      const of = (member) => exports.web_asset_mesh(handle, mesh, member);
      return {mesh: of(0), primitive: of(1), vertexCount: of(2), name: fascia.text(of(4)), part: fascia.text(of(5)),
              triangles: fascia.words(of(6), 3 * of(3)).slice()};
    });
    const of = (member) => exports.web_asset_channels(handle, member), count = of(0);
    const [names, groups, units] = [1, 2, 3].map((member) => fascia.texts(of(member), count));
    const [minimum, maximum, rest] = [4, 5, 6].map((member) => fascia.floats(of(member), count));
    this.channels = names.map((name, i) => ({
      name, group: groups[i], unit: units[i], minimum: minimum[i], maximum: maximum[i], rest: rest[i]}));
    this.sets = Object.fromEntries(Array.from({length: info(3)}, (_, set) => {
      const member = (index) => exports.web_asset_set(handle, set, index);
      return [fascia.text(member(0)), fascia.texts(member(2), member(1))];
    }));
  }

  createFace({level = -1, space = 'mesh', iterations = 0} = {}) {
    const index = typeof level === 'string' ? this.levels.findIndex(({name}) => name === level) : level;
    if (typeof level === 'string' && index < 0)
      throw new FasciaError(`there is no level '${level}': ${this.levels.map(({name}) => name).join(', ')}`);
    const handle = this.fascia.exports.web_face_create(this.handle, chosen('space', spaces, space), index, iterations);
    if (handle === 0) this.fascia.fail();
    return new Face(this, handle);
  }

  dispose() {
    this.fascia.exports.fascia_asset_release(this.handle);
    this.handle = 0;
  }
}

/** One head. Arrays it returns are views of the library's memory: use them before the next call, or copy. */
class Face {
  constructor(asset, handle) {
    this.asset = asset;
    this.fascia = asset.fascia;
    this.exports = asset.fascia.exports;
    this.handle = handle;
  }

  /** The channels' own values, to read and write. */
  get values() { return this.channelList(this.exports.fascia_face_values(this.handle)); }
  get effectiveValues() { return this.channelList(this.exports.fascia_face_effective_values(this.handle)); }
  channelList(at) {
    if (at === 0) throw new FasciaError('the face was disposed of');
    return this.fascia.floats(at, this.asset.channels.length);
  }
  set(name, value) { this.fascia.withText(name, (at) => this.exports.fascia_face_set(this.handle, at, value)); }
  get(name) {
    const at = this.exports.malloc(4);
    this.fascia.withText(name, (text) => this.exports.fascia_face_get(this.handle, text, at));
    const value = this.fascia.floats(at, 1)[0];
    this.exports.free(at);
    return value;
  }
  /** Several at once: {jawOpen: 0.3, ...}; names the rig does not know are left out, and returned. */
  setAll(values) {
    const unknown = [];
    for (const [name, value] of Object.entries(values)) {
      try {
        this.set(name, value);
      } catch (error) {
        if (!(error instanceof FasciaError) || !Number.isFinite(value)) throw error;
        unknown.push(name);
      }
    }
    return unknown;
  }
  clear() { this.fascia.check(this.exports.fascia_face_clear(this.handle)); }

  setLayer(index, {combine = 'add', weight = 1, mask = null} = {}) {
    const how = chosen('combine', combines, combine);
    const set = (at) => this.exports.web_face_set_layer(this.handle, index, how, weight, at);
    if (!mask) return this.fascia.check(set(0));
    let result = 0;
    this.fascia.withBytes(numbers('mask', mask, this.asset.channels.length), (at) => { result = set(at); return 1; });
    this.fascia.check(result);
  }
  layerValues(layer) {
    const at = this.exports.fascia_face_layer_values(this.handle, layer);
    return at === 0 ? null : this.fascia.floats(at, this.asset.channels.length);
  }
  apply(curves, seconds, weight = 1, layer = 0) {
    this.fascia.check(
        this.exports.fascia_curves_apply_to_layer(curves.handle, seconds, weight, this.handle, layer));
  }
  /** `point` in metres in the head's frame, or null. */
  lookAt(point, weight = 1) {
    if (!point) return this.fascia.check(this.exports.fascia_face_look_at(this.handle, 0, 0));
    let result = 0;
    this.fascia.withBytes(numbers('point', point, 3), (at) => {
      result = this.exports.fascia_face_look_at(this.handle, at, weight);
      return 1;
    });
    this.fascia.check(result);
  }
  blend(share, seconds) { this.fascia.check(this.exports.fascia_face_blend(this.handle, share, seconds)); }

  pose() { this.fascia.check(this.exports.fascia_face_pose(this.handle)); }
  /** Lets time pass; false when the simulation had to be put back to rest. */
  step(seconds) {
    const result = this.exports.fascia_face_step(this.handle, Math.min(1, seconds));
    if (result === 7) return false;
    this.fascia.check(result);
    return true;
  }
  reset() { this.fascia.check(this.exports.fascia_face_reset(this.handle)); }
  /** `matrix`: 16 numbers, column-major, a rigid transform in metres. */
  moveHead(matrix, inertiaScale = 1) {
    let result = 0;
    this.fascia.withBytes(numbers('matrix', matrix, 16), (at) => {
      result = this.exports.fascia_face_move_head(this.handle, at, inertiaScale);
      return 1;
    });
    this.fascia.check(result);
  }
  setLevel(level, seconds = 0.25) {
    this.fascia.check(this.exports.fascia_face_set_level(this.handle, level, seconds));
  }
  get level() { return this.exports.fascia_face_level(this.handle); }

  positions(mesh) { return this.vectors(mesh, 0); }
  normals(mesh) { return this.vectors(mesh, 1); }
  compression(mesh) { return this.vectors(mesh, 2); }
  /** Empty where the file gives the mesh neither tangents nor texture coordinates. */
  tangents(mesh) {
    const count = this.exports.web_face_tangent_count(this.handle, mesh);
    if (count < 0) this.fascia.fail();
    return count === 0 ? new Float32Array(0) : this.vectors(mesh, 3, 4);
  }
  /** @private */
  vectors(mesh, kind, width = 3) {
    const at = this.exports.web_face_vectors(this.handle, mesh, kind);
    if (at === 0) this.fascia.fail();
    return this.fascia.floats(at, width * this.asset.meshes[mesh].vertexCount);
  }

  save() {
    const size = this.exports.web_face_state_size(this.handle);
    if (size === 0) this.fascia.fail();
    const at = this.exports.malloc(size);
    const result = this.exports.web_face_save(this.handle, at, size);
    const state = this.fascia.bytes(at, size).slice();
    this.exports.free(at);
    this.fascia.check(result);
    return state;
  }
  restore(state) {
    let result = 0;
    this.fascia.withBytes(state, (at, size) => {
      result = this.exports.fascia_face_restore(this.handle, at, size);
      return 1;
    });
    this.fascia.check(result);
  }

  dispose() {
    this.exports.fascia_face_release(this.handle);
    this.handle = 0;
  }
}

/** Named values over time, from a CSV, JSON or glTF file. */
class Curves {
  constructor(fascia, handle) {
    this.fascia = fascia;
    this.handle = handle;
    const of = (member) => fascia.exports.web_curves_info(handle, member);
    this.names = fascia.texts(of(1), of(0));
    this.notes = fascia.texts(of(3), of(2));
    this.duration = fascia.exports.web_curves_duration(handle);
  }
  dispose() {
    this.fascia.exports.fascia_curves_release(this.handle);
    this.handle = 0;
  }
}
