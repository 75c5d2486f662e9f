// Serves one file, cross-origin isolated, so that its threads can run: node serve.mjs FILE [PORT]. To this machine alone.
import { readFile } from 'node:fs/promises';
import { createServer } from 'node:http';

const [file, port = '8000'] = process.argv.slice(2);
const server = createServer(async (request, response) => {
  const isPage = new URL(request.url, 'http://localhost').pathname === '/';
  response.writeHead(isPage ? 200 : 404, {
    'Content-Type': 'text/html; charset=utf-8', 'Cross-Origin-Opener-Policy': 'same-origin', 'Cross-Origin-Embedder-Policy': 'require-corp',
  });
  response.end(isPage ? await readFile(file) : undefined);
});
server.on('error', (error) => {
  console.error(`fulcrum: ${error.code === 'EADDRINUSE' ? `port ${port} is taken; name another: ./fulcrum web --serve PORT` : error.message}`);
  process.exit(1);
});
server.listen(Number(port), '127.0.0.1', () => console.log(`http://localhost:${server.address().port}/ (end with Ctrl-C)`));
