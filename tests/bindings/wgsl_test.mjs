// skinning.wgsl on WebGPU in headless Chromium, against the runtime's own vertices: wgsl_test.mjs SHADER.wgsl DATA.json, data by
// skinning_data.py. Exit 77 where Chromium has no WebGPU.
import assert from 'node:assert/strict';
import {readFileSync} from 'node:fs';
import {createServer} from 'node:http';
import {Browser} from './browser.mjs';

const [shader, data] = process.argv.slice(2);
const meshes = JSON.parse(readFileSync(data));

// One vertex an invocation, as a vertex stage would have it, and its place into a buffer.
const source = `@group(0) @binding(0) var fascia_nodes: texture_2d<f32>;
@group(0) @binding(1) var<uniform> fascia_bones: array<mat4x4<f32>, 3>;
${readFileSync(shader)}
struct Counts { vertices: u32, influences: u32 }
@group(0) @binding(2) var<storage, read> rest: array<f32>;
@group(0) @binding(3) var<storage, read> nodes: array<u32>;
@group(0) @binding(4) var<storage, read> weights: array<f32>;
@group(0) @binding(5) var<storage, read> jaw: array<f32>;
@group(0) @binding(6) var<storage, read> eyes: array<u32>;
@group(0) @binding(7) var<storage, read_write> places: array<f32>;
@group(0) @binding(8) var<uniform> counts: Counts;
@compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3<u32>) {
  let v = id.x;
  if (v >= counts.vertices) { return; }
  var pull = vec3<f32>(0.0);
  for (var i = 0u; i < counts.influences; i = i + 4u) {
    let at = v * counts.influences + i;
    pull = pull + fascia_pull(vec4<u32>(nodes[at], nodes[at + 1u], nodes[at + 2u], nodes[at + 3u]),
                              vec4<f32>(weights[at], weights[at + 1u], weights[at + 2u], weights[at + 3u]));
  }
  let place = fascia_place(vec3<f32>(rest[3u * v], rest[3u * v + 1u], rest[3u * v + 2u]), pull, jaw[v], eyes[v]);
  places[3u * v] = place.x;
  places[3u * v + 1u] = place.y;
  places[3u * v + 2u] = place.z;
}`;

/** In the page: the places of a mesh's vertices, as an array. */
async function skin(code, mesh) {
  const adapter = await navigator.gpu.requestAdapter();
  const limits = {maxStorageBuffersPerShaderStage: Math.min(8, adapter.limits.maxStorageBuffersPerShaderStage)};
  const device = await adapter.requestDevice({requiredLimits: limits});
  device.pushErrorScope('validation');
  const module = device.createShaderModule({code});
  const {messages} = await module.getCompilationInfo();
  if (messages.some(({type}) => type === 'error')) throw new Error(messages.map(({lineNum, message}) => `${lineNum}: ${message}`).join('; '));
  const bytes = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const buffer = (content, usage) => {
    const made = device.createBuffer({size: Math.max(16, content.byteLength + 3 & ~3), usage: usage | GPUBufferUsage.COPY_DST});
    device.queue.writeBuffer(made, 0, content);
    return {buffer: made};
  };
  const texels = bytes(mesh.texels), width = 64, height = Math.ceil(texels.length / 16 / width);
  const padded = new Uint8Array(16 * width * height);
  padded.set(texels);
  const texture = device.createTexture({size: [width, height], format: 'rgba32float', usage: GPUTextureUsage.TEXTURE_BINDING | GPUTextureUsage.COPY_DST});
  device.queue.writeTexture({texture}, padded, {bytesPerRow: 16 * width}, [width, height]);
  const {STORAGE, UNIFORM, COPY_SRC, COPY_DST, MAP_READ} = GPUBufferUsage;
  const places = buffer(new Uint8Array(12 * mesh.vertices), STORAGE | COPY_SRC);
  const pipeline = await device.createComputePipelineAsync({layout: 'auto', compute: {module, entryPoint: 'main'}});
  const bound = [texture.createView(), buffer(bytes(mesh.bones), UNIFORM), buffer(bytes(mesh.rest), STORAGE), buffer(bytes(mesh.nodes), STORAGE),
                 buffer(bytes(mesh.weights), STORAGE), buffer(bytes(mesh.jaw), STORAGE), buffer(bytes(mesh.eyes), STORAGE), places,
                 buffer(new Uint32Array([mesh.vertices, mesh.influences, 0, 0]), UNIFORM)];
  const group = device.createBindGroup({layout: pipeline.getBindGroupLayout(0), entries: bound.map((resource, binding) => ({binding, resource}))});
  const commands = device.createCommandEncoder(), pass = commands.beginComputePass();
  pass.setPipeline(pipeline);
  pass.setBindGroup(0, group);
  pass.dispatchWorkgroups(Math.ceil(mesh.vertices / 64));
  pass.end();
  const read = device.createBuffer({size: 12 * mesh.vertices, usage: MAP_READ | COPY_DST});
  commands.copyBufferToBuffer(places.buffer, 0, read, 0, 12 * mesh.vertices);
  device.queue.submit([commands.finish()]);
  const error = await device.popErrorScope();
  if (error) throw new Error(error.message);
  await read.mapAsync(GPUMapMode.READ);
  return Array.from(new Float32Array(read.getMappedRange()));
}

process.env.FASCIA_CHROMIUM_FLAGS = '--enable-unsafe-webgpu --use-webgpu-adapter=swiftshader --enable-features=Vulkan';
// WebGPU is for secure places, which 127.0.0.1 is and about:blank is not.
const server = createServer((_, response) => response.writeHead(200, {'content-type': 'text/html'}).end('<!doctype html>'));
await new Promise((ready) => server.listen(0, '127.0.0.1', ready));
let browser;
const end = (code) => {
  browser?.close();
  process.exit(code);
};
for (const signal of ['SIGTERM', 'SIGINT']) process.on(signal, () => end(1));
try {
  for (const gpu of [false, true]) {
    browser = await Browser.launch({gpu});
    await browser.send('Page.navigate', {url: `http://127.0.0.1:${server.address().port}/`});
    await browser.until('document.readyState === "complete" && location.protocol === "http:"');
    if (await browser.ask('navigator.gpu?.requestAdapter().then((adapter) => adapter !== null) ?? false')) break;
    browser.close();
    browser = null;
  }
  if (!browser) {
    console.log('wgsl: left out, Chromium has no WebGPU here');
    end(77);
  }
  const f32 = (text) => new Float32Array(new Uint8Array(Buffer.from(text, 'base64')).buffer);
  let worst = 0, moved = 0, vertices = 0;
  for (const mesh of meshes) {
    const {positions, ...given} = mesh;
    const found = await browser.ask(`(${skin})(${JSON.stringify(source)}, ${JSON.stringify(given)})`);
    const expected = f32(positions), rest = f32(mesh.rest);
    assert.equal(found.length, expected.length);
    for (let i = 0; i < found.length; ++i) {
      worst = Math.max(worst, Math.abs(found[i] - expected[i]));
      moved = Math.max(moved, Math.abs(rest[i] - expected[i]));
    }
    vertices += mesh.vertices;
  }
  assert.ok(moved > 1e-3, `nothing moves: ${moved}`);
  assert.ok(worst < 1e-5, `${worst} m from the runtime's vertices`);
  console.log(`wgsl: ${vertices} vertices of ${meshes.length} meshes, at most ${worst.toExponential(1)} m from the runtime's`);
  end(0);
} catch (error) {
  console.error(error);
  end(1);
}
