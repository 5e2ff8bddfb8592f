// node traverse.cjs ARCHIVE.3tz: walks the implicit tileset with the traverser of 3d-tiles-tools (subtrees, property tables, metadata semantics) and counts the
// tiles; they must be as many as the archive's extension says, each with a finite box and error and without content.
"use strict";
const path = require("path");
const tools = require("3d-tiles-tools");

function check(condition, message) {
  if (!condition) throw new Error(message);
}

async function main(archive) {
  const source = await tools.TilesetSources.createAndOpen(archive);
  const resolver = new tools.TilesetSourceResourceResolver(".", source);
  const tileset = JSON.parse((await source.getValue("tileset.json")).toString("utf8"));
  const extension = tileset.extensions.CITYSTREAM_layers;
  const traverser = new tools.TilesetTraverser(path.dirname(archive), resolver, { depthFirst: true });
  // The traverser shows the explicit root and the implicit root below it as two tiles: one tile and one level more than there are.
  let count = 0;
  await traverser.traverse(tileset, async (traversed) => {
    const tile = traversed.asFinalTile();
    const box = tile.boundingVolume.box;
    check(box.length === 12 && box.every(Number.isFinite), `${traversed.path}: no bounding box`);
    check(Number.isFinite(tile.geometricError), `${traversed.path}: no geometric error`);
    check(traversed.getFinalContents().length === 0, `${traversed.path}: has content`);
    check(traversed.level <= tileset.root.implicitTiling.availableLevels, `${traversed.path}: too deep`);
    count += 1;
    return true;
  });
  check(count === extension.totals.tiles + 1, `${count} tiles traversed, ${extension.totals.tiles} in the archive`);
  await source.close();
  console.log(`${count - 1} tiles traversed`);
}

main(process.argv[2]).catch((reason) => {
  console.error(`traverse.cjs: failed: ${reason.stack}`);
  process.exit(1);
});
