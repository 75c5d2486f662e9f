// Writes the types of all settings, out of the schema of scene files, which the engine makes from its own fields:
// node types.mjs SCHEMA OUTPUT. The schema uses a few words of JSON Schema; another one is an error here.
import { readFileSync } from 'node:fs';

import { writeWholeFile } from '../../Docs/wholeFile.mjs';

const [input, output] = process.argv.slice(2);
if (!output) {
  console.error('usage: node types.mjs SCHEMA OUTPUT');
  process.exit(2);
}
const schema = JSON.parse(readFileSync(input, 'utf8'));

// JavaScript has infinities, and whoever has a vector need not say that it has three numbers.
const KNOWN = { number: 'number', vector: 'readonly number[]', rotation: 'readonly number[]', shape: 'unknown' };
const WORDS = new Set(['type', 'properties', 'required', 'additionalProperties', 'enum', 'const', 'anyOf', 'oneOf', '$ref', 'items',
  'minItems', 'maxItems', 'minimum', 'maximum', 'default', 'description']);

function typeOf(node, indent = '') {
  for (const word of Object.keys(node)) if (!WORDS.has(word)) throw new Error(`types.mjs does not know "${word}" of the schema`);
  if (node.$ref) return KNOWN[node.$ref.replace('#/$defs/', '')] ?? typeOf(schema.$defs[node.$ref.replace('#/$defs/', '')], indent);
  if (node.const !== undefined) return JSON.stringify(node.const);
  if (node.enum) return node.enum.map((value) => JSON.stringify(value)).join(' | ');
  const choices = node.anyOf ?? node.oneOf;
  if (choices) return choices.map((choice) => typeOf(choice, indent)).join(' | ');
  if (node.type === 'array') return `readonly (${[node.items].flat().map((item) => typeOf(item, indent)).join(' | ')})[]`;
  if (node.type === 'object') {
    const lines = Object.entries(node.properties).map(([name, field]) => {
      const byDefault = field.default === undefined ? '' : `${indent}  /** By default ${JSON.stringify(field.default)}. */\n`;
      const isNeeded = node.required?.includes(name) || field.const !== undefined;
      return `${byDefault}${indent}  ${name}${isNeeded ? '' : '?'}: ${typeOf(field, `${indent}  `)};\n`;
    });
    return `{\n${lines.join('')}${indent}}`;
  }
  return { integer: 'number', boolean: 'boolean', string: 'string', null: 'null', number: 'number' }[node.type];
}

const { joint, body } = schema.$defs;
// Bodies of a joint are ids here, not names of a file.
const joints = joint.oneOf.map(({ properties: { name, bodyA, bodyB, ...properties } }) => ({ type: 'object', properties }));
const control = joints.find(({ properties }) => properties.kind.const === 'Hinge').properties.angle.properties;
const named = {
  WorldFields: schema.properties.settings, BodyFields: body, JointFields: { oneOf: joints }, MaterialFields: body.properties.material,
  MotorFields: control.motor, LimitFields: control.limits, SpringFields: control.limits.properties.spring,
};
writeWholeFile(output, `// Written by types.mjs.\n${Object.entries(named).map(([name, node]) => `export type ${name} = ${typeOf(node)};\n`).join('')}`);
