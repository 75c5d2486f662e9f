// Bundles Page/ into one web page: node build.mjs OUTPUT. Called by CMake. HtmlWriter.cpp puts a recording in its place.
import { build } from 'esbuild';
import { readFileSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

const output = process.argv[2];
if (!output) {
  console.error('usage: node build.mjs OUTPUT');
  process.exit(2);
}
const source = join(dirname(fileURLToPath(import.meta.url)), 'Page');

const result = await build({
  entryPoints: [join(source, 'main.js'), join(source, 'style.css')],
  bundle: true,
  minify: true,
  format: 'iife',
  target: 'es2020',
  charset: 'utf8',
  legalComments: 'inline',
  outdir: 'unused',
  write: false,
});
const textOf = (ending) => result.outputFiles.find((file) => file.path.endsWith(ending)).text;

// A function as replacement: in a string, $ would be special. No script may hold the tag that ends it.
const page = readFileSync(join(source, 'index.html'), 'utf8')
  .replace('/*STYLE*/', () => textOf('.css'))
  .replace('/*SCRIPT*/', () => textOf('.js').replaceAll('</script', '<\\/script'));
writeFileSync(output, page);
