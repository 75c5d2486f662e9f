// Replaces a file whole or not at all: it is written beside the one of its name, and then renamed. For the scripts that write
// files of this tree; programs have Physics/Files/WholeFile.h.
import { existsSync, realpathSync, renameSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';

export function writeWholeFile(name, content) {
  const file = existsSync(name) ? realpathSync(name) : name;
  // Devices and pipes are written directly.
  if (existsSync(file) && !statSync(file).isFile()) return writeFileSync(file, content);
  const part = join(dirname(file), `.fulcrum-${process.pid}-${Date.now().toString(36)}.part`);
  try {
    writeFileSync(part, content, { flag: 'wx', mode: existsSync(file) ? statSync(file).mode : 0o666 });
    renameSync(part, file);
  } catch (error) {
    rmSync(part, { force: true });
    throw error;
  }
}
