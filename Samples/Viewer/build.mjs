// Bundles a folder with index.html, main.js and style.css into one web page: node build.mjs FOLDER OUTPUT. Called by CMake, for
// the viewer (Page/) and for the accuracy lab's report. C++ puts the data in their place.
import { build } from 'esbuild';
import { existsSync, readFileSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

const [source, output] = process.argv.slice(2);
if (!output) {
  console.error('usage: node build.mjs FOLDER OUTPUT');
  process.exit(2);
}
// Pages elsewhere use the packages beside this file.
const packages = join(dirname(fileURLToPath(import.meta.url)), 'node_modules');

const result = await build({
  entryPoints: [join(source, 'main.js'), join(source, 'style.css')],
  bundle: true,
  nodePaths: [packages],
  minify: true,
  format: 'iife',
  target: 'es2020',
  charset: 'utf8',
  legalComments: 'inline',
  outdir: 'unused',
  write: false,
  metafile: true,
});
const textOf = (ending) => result.outputFiles.find((file) => file.path.endsWith(ending)).text;

// The licenses of what is bundled, each text once.
function licenses() {
  const names = new Set();
  for (const file of Object.keys(result.metafile.inputs)) {
    const [, name] = file.match(/.*node_modules\/((?:@[^/]+\/)?[^/]+)/) ?? [];
    if (name) names.add(name);
  }
  const namesOf = new Map();
  for (const name of [...names].sort()) {
    const file = ['LICENSE', 'LICENSE.md', 'LICENSE.txt', 'license', 'License'].map((each) => join(packages, name, each)).find(existsSync);
    const text = file ? readFileSync(file, 'utf8').trim() : `See the package ${name}`;
    namesOf.set(text, [...(namesOf.get(text) ?? []), name]);
  }
  return [...namesOf].map(([text, all]) => `${all.join(', ')}:\n${text}`).join('\n\n').replaceAll('--', '- -');
}

// A function as replacement: in a string, $ would be special. No script may hold the tag that ends it.
const page = readFileSync(join(source, 'index.html'), 'utf8')
  .replace('/*STYLE*/', () => textOf('.css'))
  .replace('/*SCRIPT*/', () => textOf('.js').replaceAll('</script', '<\\/script'));
writeFileSync(output, `${page}\n<!--\n${licenses()}\n-->\n`);
