// Follows the recipes of Docs/Adding.md for a scene and a joint: node adding.mjs SOURCE FOLDER writes their files, and the edited lists
// of the tree, into FOLDER/Fulcrum, which stands before the tree among the folders of includes. The first word after a block's
// language is its file; a block for a file that is there is added to it.
import { existsSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';

const [source, folder] = process.argv.slice(2);
const read = (file) => readFileSync(join(source, file), 'utf8');
const write = (file, text) => {
  mkdirSync(dirname(join(folder, 'Fulcrum', file)), { recursive: true });
  writeFileSync(join(folder, 'Fulcrum', file), text);
};
function replaced(text, pattern, by) {
  if (!pattern.test(text)) throw new Error(`${pattern} is not there`);
  return text.replace(pattern, by);
}

const files = new Set();
for (const [, indent, file, body] of read('Docs/Adding.md').matchAll(/^( *)```cpp (\S+)\n([\s\S]*?)^ *```$/gm)) {
  const text = body.split('\n').map((line) => line.slice(indent.length)).join('\n');
  write(file, existsSync(join(source, file)) ? replaced(read(file), /(\n}  \/\/ namespace fulcrum\n)/, `\n${text}$1`) : text);
  files.add(file);
}
for (const file of ['Samples/Scenes/Staircase.cpp', 'Physics/Joints/ScrewJoint.h', 'Physics/Joints/ScrewJoint.cpp', 'Physics/SettingsFields.h'])
  if (!files.has(file)) throw new Error(`Docs/Adding.md has no block for ${file}`);

const kinds = replaced(read('Physics/Joints/JointKinds.h'), /call\(Custom\)/, 'call(Screw) call(Custom)');
write('Physics/Joints/JointKinds.h', replaced(kinds, /(#include <Fulcrum\/Physics\/Joints\/SixDofJoint.h>)/, '#include <Fulcrum/Physics/Joints/ScrewJoint.h>\n$1'));
write('Samples/Scenes/Scenes.cpp', replaced(read('Samples/Scenes/Scenes.cpp'), /scene\(/, 'scene(Staircase) scene('));
