// Space and the arrows play and step whatever was clicked before; a control that was reached by the keyboard keeps its keys.
import assert from 'node:assert/strict';
import { after, before, beforeEach, test } from 'node:test';
import { launch, openPage } from './browser.mjs';
import { html } from './recording.mjs';

let browser, page;
before(async () => {
  browser = await launch();
  page = await openPage(browser, html);
  await page.locator('#speed').selectOption('0.05'); // else a slow machine has come to the end before it is asked
});
after(() => browser?.close());

const frame = () => page.evaluate(() => window.fulcrum.frame);
const isPlaying = () => page.evaluate(() => window.fulcrum.playing);
const seek = (wanted) => page.evaluate((value) => window.fulcrum.seek(value), wanted);
const isChecked = (control) => page.locator(control).isChecked();

async function expectPageKeys(what) {
  await seek(20);
  await page.keyboard.press('ArrowRight');
  assert.equal(await frame(), 21, `${what}: the right arrow does not step`);
  await page.keyboard.press('ArrowLeft');
  await page.keyboard.press('ArrowLeft');
  assert.equal(await frame(), 19, `${what}: the left arrow does not step back`);
  await page.keyboard.press('Space');
  assert.ok(await isPlaying(), `${what}: space does not play`);
  await page.keyboard.press('Space');
  assert.ok(!(await isPlaying()), `${what}: space does not pause`);
}

beforeEach(() => page.evaluate(() => document.activeElement.blur()));

test('after a click on any button', async () => {
  for (const button of ['#back', '#play', '#forward']) {
    await page.locator(button).click();
    await expectPageKeys(button);
  }
});

test('after a click on a switch, which stays as it was set', async () => {
  for (const what of ['contacts', 'normals', 'bounds', 'grid']) {
    const toggle = `#toggles input[value=${what}]`;
    const before = await isChecked(toggle);
    await page.locator(toggle).click();
    await expectPageKeys(what);
    assert.equal(await isChecked(toggle), !before, `${what} was switched by a key`);
    await page.locator(toggle).click();
  }
});

test('after a click on a coloring, which stays chosen', async () => {
  for (const mode of ['plain', 'speed', 'awake', 'island']) {
    await page.locator(`#colors label:has(input[value=${mode}])`).click();
    await expectPageKeys(mode);
    assert.ok(await isChecked(`#colors input[value=${mode}]`), `a key chose another coloring than ${mode}`);
  }
});

test('after a click on the slider', async () => {
  await page.locator('#scrub').click();
  await expectPageKeys('the slider');
});

test('after a click on the speed, which stays as it was', async () => {
  const speed = () => page.locator('#speed').inputValue();
  const before = await speed();
  await page.locator('#speed').click();
  await page.keyboard.press('Escape'); // closes its list
  await expectPageKeys('the speed');
  assert.equal(await speed(), before);
});

test('what was reached by the keyboard keeps its keys', async () => {
  await seek(20);
  await page.locator('#canvas').click({ position: { x: 5, y: 200 } });
  const focus = async (id) => {
    for (let i = 0; i < 20; ++i) {
      await page.keyboard.press('Tab');
      if (await page.evaluate((wanted) => document.activeElement.matches(wanted), id)) return;
    }
    assert.fail(`${id} is not reached by the tabulator key`);
  };
  await focus('#forward');
  await page.keyboard.press('Space');
  assert.equal(await frame(), 21, 'space does not press the button');
  assert.ok(!(await isPlaying()));
  await focus('#colors input[value=island]');
  await page.keyboard.press('ArrowRight');
  assert.ok(await isChecked('#colors input[value=speed]'), 'the arrow does not choose');
  assert.equal(await frame(), 21);
  await page.locator('#colors input[value=island]').check();
});
