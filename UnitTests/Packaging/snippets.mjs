// The programs of the documents: node snippets.mjs SOURCE FOLDER [--without-assets] writes guide.cpp, the snippets of Docs/Guide.md as
// functions that main calls one after the other, and expected.txt, what they are to print; and readme.cpp, the program of
// README.md. Without Fulcrum::Assets the snippets that include it are left out.
import { mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';

const [source, folder, option] = process.argv.slice(2);
const blocks = (text) => [...text.matchAll(/^```([^\n]*)\n([\s\S]*?)^```$/gm)].map(([, kind, body]) => ({ kind, body }));

const guide = blocks(readFileSync(join(source, 'Docs/Guide.md'), 'utf8'));
const shared = guide.filter(({ kind }) => kind === 'cpp shared').map(({ body }) => body);
const snippets = [];
guide.forEach(({ kind, body }, i) => {
  if (kind !== 'cpp') return;
  if (guide[i + 1]?.kind !== 'text') throw new Error(`what does this snippet print?\n${body}`);
  if (option === '--without-assets' && body.includes('#include <Fulcrum/Assets/')) return;
  const lines = body.split('\n'), isInclude = (line) => line.startsWith('#include ');
  snippets.push({ includes: lines.filter(isInclude), body: lines.filter((line) => !isInclude(line)).join('\n'), text: guide[i + 1].body });
});
if (snippets.length === 0 || shared.length === 0) throw new Error('Docs/Guide.md has no snippets');

const readme = blocks(readFileSync(join(source, 'README.md'), 'utf8')).find(({ kind }) => kind === 'cpp');
if (!readme) throw new Error('README.md has no program');

mkdirSync(folder, { recursive: true });
writeFileSync(join(folder, 'guide.cpp'), `${snippets.flatMap(({ includes }) => includes).join('\n')}
${shared.join('\n')}
${snippets.map(({ body }, i) => `static void Snippet${i}() {\n${body}}\n`).join('\n')}
int main() {
${snippets.map((_, i) => `    Snippet${i}();`).join('\n')}
}
`);
writeFileSync(join(folder, 'expected.txt'), snippets.map(({ text }) => text).join(''));
writeFileSync(join(folder, 'readme.cpp'), readme.body);
