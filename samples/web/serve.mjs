// Serves this folder, the packages it needs and a rig. `npm run dev -- RIG.glb`: ../../out/rig.glb when left out.
import {createReadStream, existsSync, realpathSync, statSync} from 'node:fs';
import {createServer} from 'node:http';
import {dirname, extname, join, normalize, resolve} from 'node:path';
import {fileURLToPath} from 'node:url';

const here = dirname(fileURLToPath(import.meta.url));
const rig = resolve(process.argv[2] ?? join(here, '../../out/rig.glb'));
const types = {'.html': 'text/html', '.mjs': 'text/javascript', '.js': 'text/javascript', '.wasm': 'application/wasm',
               '.csv': 'text/csv', '.glb': 'model/gltf-binary', '.css': 'text/css'};

const server = createServer((request, response) => {
  const path = normalize(decodeURIComponent(new URL(request.url, 'http://localhost').pathname));
  const file = path === '/rig.glb' ? rig : join(here, path === '/' ? 'index.html' : path);
  const inside = path === '/rig.glb' || (existsSync(file) && realpathSync(dirname(file)) && file.startsWith(here));
  if (!inside || !existsSync(file) || !statSync(file).isFile()) {
    response.writeHead(404).end(`${path} is not there\n`);
    return;
  }
  response.writeHead(200, {'content-type': types[extname(file)] ?? 'application/octet-stream'});
  createReadStream(file).pipe(response);
});
server.listen(Number(process.env.PORT ?? 8080), '127.0.0.1', () => {
  if (!existsSync(rig)) console.log(`${rig} is not there: run scripts/demo.sh, or drop a rig on the page`);
  console.log(`http://127.0.0.1:${server.address().port}/`);
});
