// Plots of the accuracy lab as one picture: node curves.mjs REPORT OUTPUT.svg SCENE... REPORT is a report.html of
// ./fulcrum accuracy. Costs are traversals of constraints, the same on every machine. CHROMIUM names the browser.
import { resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { launch } from './test/browser.mjs';

import { writeWholeFile } from '../../Docs/wholeFile.mjs';

const COLUMNS = 2, WIDTH = 580, HEIGHT = 340, TITLE = 26, GAP = 12; // px

const [report, output, ...scenes] = process.argv.slice(2);
if (scenes.length === 0) {
  console.error('usage: node curves.mjs REPORT OUTPUT.svg SCENE...');
  process.exit(2);
}

const browser = await launch();
try {
  const page = await browser.newPage({ viewport: { width: 1320, height: 400 * scenes.length } });
  await page.goto(`${pathToFileURL(resolve(report))}?scenes=${scenes.join(',')}&cost=traversals_per_second`);
  const plots = [];
  for (const scene of scenes) {
    const card = page.locator(`[id="${scene}"]`);
    if (await card.count() === 0) throw new Error(`${report} has no scene ${scene}`);
    await card.scrollIntoViewIfNeeded();
    await card.locator('.plot svg').first().waitFor();
    plots.push(await card.evaluate((element) => {
      // The page's pointer and links have no place in a picture.
      const svg = element.querySelector('.plot svg').cloneNode(true);
      svg.querySelectorAll('.hover, .recordings').forEach((layer) => layer.remove());
      return { error: element.querySelector('.what-error').textContent, svg: new XMLSerializer().serializeToString(svg) };
    }));
  }
  const legend = await page.evaluate(() => [...document.querySelectorAll('#legend span')].map((span) => ({ label: span.textContent, color: getComputedStyle(span.firstChild).backgroundColor })));
  const escape = (text) => text.replaceAll('&', '&amp;').replaceAll('<', '&lt;');
  const rows = Math.ceil(plots.length / COLUMNS), width = COLUMNS * (WIDTH + GAP), height = 30 + rows * (TITLE + HEIGHT + GAP);
  let x = 12;
  const keys = legend.map(({ label, color }) => {
    const key = `<rect x="${x}" y="12" width="18" height="4" rx="2" fill="${color}"/><text x="${x + 24}" y="18">${escape(label)}</text>`;
    x += 50 + 7 * label.length;
    return key;
  });
  const placed = plots.map(({ error, svg }, i) => {
    const left = (i % COLUMNS) * (WIDTH + GAP), top = 30 + Math.floor(i / COLUMNS) * (TITLE + HEIGHT + GAP);
    return `<text x="${left + 12}" y="${top + 16}"><tspan font-weight="bold">${escape(scenes[i])}</tspan>  ${escape(error)}</text>
${svg.replace('<svg ', `<svg x="${left}" y="${top + TITLE}" `)}`;
  });
  writeWholeFile(output, `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${width} ${height}" width="${width}" height="${height}">
<title>Error against cost: ${scenes.map(escape).join(', ')}</title>
<rect width="${width}" height="${height}" fill="white"/>
<g font-family="system-ui, sans-serif" font-size="13" fill="#1d2733">
${keys.join('\n')}
${placed.join('\n')}
</g>
</svg>
`);
} finally {
  await browser.close();
}
