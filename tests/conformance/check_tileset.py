#!/usr/bin/env python3
"""check_tileset.py ARCHIVE.3tz: checks an archive's directory against OGC 3D Tiles 1.1 (implicit tiling, 3D Metadata, subtree binary format), 3TZ 1.3 and
citystream's own promises (FORMAT.md), with nothing but the standard library and without a line of the programs that wrote it.

Prints one line per defect and a summary. Exit code 0: none found; 1: defects; 2: wrong usage.
"""

import hashlib
import json
import math
import re
import struct
import sys
import zipfile

EXTENSION = "CITYSTREAM_layers"
IDENTIFIER = re.compile(r"^[a-zA-Z_][a-zA-Z0-9_]*$")
SIZES = {"INT8": 1, "UINT8": 1, "INT16": 2, "UINT16": 2, "INT32": 4, "UINT32": 4, "INT64": 8, "UINT64": 8, "FLOAT32": 4, "FLOAT64": 8}
CODES = {"INT8": "b", "UINT8": "B", "INT16": "h", "UINT16": "H", "INT32": "i", "UINT32": "I", "INT64": "q", "UINT64": "Q", "FLOAT32": "f", "FLOAT64": "d"}
TYPES = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
# Semantic -> (type, component types, array, count) of the 3D Metadata Semantic Reference.
SEMANTICS = {
    "TILE_BOUNDING_BOX": ("SCALAR", {"FLOAT32", "FLOAT64"}, True, 12),
    "TILE_BOUNDING_REGION": ("SCALAR", {"FLOAT64"}, True, 6),
    "TILE_BOUNDING_SPHERE": ("SCALAR", {"FLOAT32", "FLOAT64"}, True, 4),
    "TILE_MINIMUM_HEIGHT": ("SCALAR", {"FLOAT32", "FLOAT64"}, False, None),
    "TILE_MAXIMUM_HEIGHT": ("SCALAR", {"FLOAT32", "FLOAT64"}, False, None),
    "TILE_GEOMETRIC_ERROR": ("SCALAR", {"FLOAT32", "FLOAT64"}, False, None),
    "TILE_REFINE": ("SCALAR", {"UINT8"}, False, None),
}


class Checker:
    def __init__(self, path):
        self.path = path
        self.defects = []
        self.tiles = {}
        self.subtrees = 0
        self.zip = zipfile.ZipFile(path)
        self.sizes = {}

    def expect(self, condition, message):
        if not condition:
            self.defects.append(message)
        return condition

    # ------------------------------------------------------------------ the archive

    def check_archive(self):
        infos = self.zip.infolist()
        self.expect(infos and infos[-1].filename == "@3dtilesIndex1@", "archive: the last entry is not @3dtilesIndex1@")
        for info in infos:
            name = info.filename
            self.expect(info.compress_type == zipfile.ZIP_STORED, f"{name}: is not stored")
            self.expect(not name.startswith("/") and "\\" not in name and ".." not in name.split("/"), f"{name}: unsafe name")
            self.expect(".3tz" not in name, f"{name}: contains .3tz")
            self.expect(name not in self.sizes, f"{name}: appears twice")
            self.sizes[name] = info.file_size
        damaged = self.zip.testzip()
        self.expect(damaged is None, f"{damaged}: wrong CRC-32")
        with open(self.path, "rb") as file:
            for info in infos:
                file.seek(info.header_offset)
                header = struct.unpack("<IHHHHHIIIHH", file.read(30))
                fits = header[0] == 0x04034B50 and header[6] == info.CRC and header[7] == header[8] == info.file_size > 0
                self.expect(fits, f"{info.filename}: local header lacks CRC-32 or sizes")
        index = self.zip.read("@3dtilesIndex1@")
        entries = [(hashlib.md5(i.filename.encode()).digest(), i.header_offset) for i in infos[:-1]]
        entries.sort(key=lambda entry: struct.unpack("<QQ", entry[0]))
        expected = b"".join(digest + struct.pack("<Q", offset) for digest, offset in entries)
        self.expect(index == expected, "@3dtilesIndex1@: differs from the sorted hashes of the names")

    # ------------------------------------------------------------------ tileset.json

    def check_tileset(self):
        tileset = json.loads(self.zip.read("tileset.json").decode("utf-8"), parse_constant=lambda c: self.expect(False, f"tileset.json: {c}"))
        self.tileset = tileset
        allowed = {"asset", "properties", "schema", "schemaUri", "statistics", "groups", "metadata", "geometricError", "root",
                   "extensionsUsed", "extensionsRequired", "extensions", "extras"}
        self.expect(set(tileset) <= allowed, f"tileset.json: unknown properties {set(tileset) - allowed}")
        self.expect(tileset["asset"].get("version") == "1.1", "tileset.json: asset.version is not 1.1")
        self.expect(is_size(tileset.get("geometricError")), "tileset.json: geometricError")
        used = tileset.get("extensionsUsed", [])
        self.expect(len(used) == len(set(used)) and used, "tileset.json: extensionsUsed")
        self.expect(set(tileset.get("extensions", {})) <= set(used), "tileset.json: an extension is not in extensionsUsed")
        self.expect(set(tileset.get("extensionsRequired", [])) <= set(used), "tileset.json: a required extension is not in extensionsUsed")
        self.check_root(tileset["root"])
        self.check_schema(tileset["schema"])
        self.check_extension(tileset["extensions"][EXTENSION])

    def check_root(self, root):
        box = root["boundingVolume"]["box"]
        self.expect(len(box) == 12 and all(is_number(v) for v in box), "root: box")
        self.root_box = box
        self.expect(is_size(root.get("geometricError")), "root: geometricError")
        self.expect(root.get("refine") in ("ADD", "REPLACE"), "root: refine")
        for forbidden in ("children", "metadata", "content", "contents"):
            self.expect(forbidden not in root, f"root: an implicit root without content must omit {forbidden}")
        tiling = root["implicitTiling"]
        self.expect(tiling.get("subdivisionScheme") == "QUADTREE", "implicitTiling: subdivisionScheme")
        for key in ("subtreeLevels", "availableLevels"):
            self.expect(is_count(tiling.get(key)) and tiling[key] >= 1, f"implicitTiling: {key}")
        for variable in ("{level}", "{x}", "{y}"):
            self.expect(variable in tiling["subtrees"]["uri"], f"implicitTiling: subtrees.uri lacks {variable}")
        self.tiling = tiling

    def check_schema(self, schema):
        self.expect(IDENTIFIER.match(schema.get("id", "")), "schema: id")
        for class_id, entity in schema.get("classes", {}).items():
            self.expect(IDENTIFIER.match(class_id), f"schema: class id {class_id}")
            semantics = [p["semantic"] for p in entity["properties"].values() if "semantic" in p]
            self.expect(len(semantics) == len(set(semantics)), f"schema: class {class_id} uses a semantic twice")
            self.expect(len(entity["properties"]) >= 1, f"schema: class {class_id} has no properties")
            for property_id, definition in entity["properties"].items():
                self.check_property(f"schema: {class_id}.{property_id}", property_id, definition)
        self.properties = schema["classes"]["tile"]["properties"]

    def check_property(self, where, property_id, definition):
        self.expect(IDENTIFIER.match(property_id), f"{where}: id")
        self.expect(definition.get("type") in TYPES, f"{where}: type")
        self.expect(definition.get("componentType") in SIZES, f"{where}: componentType")
        self.expect(definition.get("description", "x") != "", f"{where}: empty description")
        if "count" in definition:
            self.expect(definition.get("array") is True and definition["count"] >= 2, f"{where}: count")
        if definition.get("required"):
            self.expect("noData" not in definition and "default" not in definition, f"{where}: required and yet noData or default")
        semantic = definition.get("semantic")
        if semantic in SEMANTICS:
            kind, components, array, count = SEMANTICS[semantic]
            fits = (definition["type"] == kind and definition["componentType"] in components and definition.get("array", False) == array
                    and definition.get("count") == count)
            self.expect(fits, f"{where}: does not have the type of its semantic {semantic}")
        elif semantic is not None:
            self.expect(not semantic.startswith(("TILE_", "CONTENT_", "TILESET_")), f"{where}: unknown semantic {semantic}")

    def check_extension(self, extension):
        self.extension = extension
        unit = 2.0 ** -extension["gridBits"]
        half = 2.0 ** extension["rootSideLog2"] / 2
        centre = [int(extension["origin"][axis]) * unit + half for axis in "xy"]
        self.expect(self.root_box[:2] == centre and self.root_box[3] == half and self.root_box[7] == half, "root: box is not the root square")
        extent = extension["extent"]
        self.expect(all(low <= high for low, high in zip(extent["min"], extent["max"])), f"{EXTENSION}: extent")
        inside = all(-unit <= extent["min"][i] and extent["max"][i] <= 2 * half + unit for i in range(2))
        self.expect(inside, f"{EXTENSION}: the extent leaves the root square")
        for layer in extension["layers"]:
            for suffix in ("Ends", "DecodedBytes", "Errors", "Checksums"):
                self.expect(layer + suffix in self.properties, f"schema: {layer}{suffix} is missing")

    # ------------------------------------------------------------------ subtrees

    def check_subtrees(self):
        waiting = [(0, 0, 0)]
        while waiting:
            root = waiting.pop()
            self.subtrees += 1
            name = fill(self.tiling["subtrees"]["uri"], root)
            if self.expect(name in self.sizes, f"{name}: is available but not in the archive"):
                waiting += self.check_subtree(name, root)

    def check_subtree(self, name, root):
        data = self.zip.read(name)
        magic, version, json_bytes, binary_bytes = struct.unpack_from("<4sIQQ", data)
        self.expect(magic == b"subt" and version == 1, f"{name}: header")
        self.expect(json_bytes % 8 == 0 and binary_bytes % 8 == 0, f"{name}: chunks do not end on 8 bytes")
        self.expect(24 + json_bytes + binary_bytes == len(data), f"{name}: lengths")
        text = data[24:24 + json_bytes]
        self.expect(text.rstrip(b" ").endswith(b"}"), f"{name}: JSON is not padded with spaces")
        subtree = json.loads(text.decode("utf-8"))
        views = self.read_views(name, subtree, data[24 + json_bytes:])
        self.expect("contentAvailability" not in subtree and "contentMetadata" not in subtree, f"{name}: content of a tileset without content")
        levels = self.tiling["subtreeLevels"]
        tiles = self.read_bits(name, "tileAvailability", subtree, views, (4 ** levels - 1) // 3)
        children = self.read_bits(name, "childSubtreeAvailability", subtree, views, 4 ** levels)
        addresses = self.list_tiles(name, root, tiles)
        self.check_table(name, subtree, views, addresses)
        bottom = tiles[(4 ** (levels - 1) - 1) // 3:]
        for morton, available in enumerate(children):
            self.expect(not available or bottom[morton // 4], f"{name}: child subtree {morton} has no parent tile")
        return [locate(root, levels, morton) for morton, available in enumerate(children) if available]

    def read_views(self, name, subtree, binary):
        buffers = subtree.get("buffers", [])
        self.expect(len(buffers) == 1 and "uri" not in buffers[0], f"{name}: buffers")
        length = buffers[0]["byteLength"]
        self.expect(1 <= length <= len(binary) < length + 8, f"{name}: buffer length")
        self.expect(not any(binary[length:]), f"{name}: binary chunk is not padded with zeros")
        views = []
        end = 0
        for i, view in enumerate(subtree.get("bufferViews", [])):
            offset, size = view["byteOffset"], view["byteLength"]
            self.expect(view["buffer"] == 0 and offset % 8 == 0 and size >= 1 and offset + size <= length, f"{name}: bufferViews.{i}")
            self.expect(offset >= end, f"{name}: bufferViews.{i} overlaps the one before")
            end = offset + size
            views.append(binary[offset:offset + size])
        return views

    def read_bits(self, name, key, subtree, views, count):
        availability = subtree[key]
        self.expect(("constant" in availability) != ("bitstream" in availability), f"{name}: {key}")
        if "constant" in availability:
            self.expect(availability["constant"] in (0, 1), f"{name}: {key}.constant")
            bits = [availability["constant"] == 1] * count
        else:
            stream = views[availability["bitstream"]]
            self.expect(len(stream) == (count + 7) // 8, f"{name}: {key} has {len(stream)} bytes for {count} bits")
            bits = [stream[i // 8] >> (i % 8) & 1 == 1 for i in range(count)]
            self.expect(count % 8 == 0 or stream[-1] >> (count % 8) == 0, f"{name}: {key} has bits after its end")
        if "availableCount" in availability:
            self.expect(availability["availableCount"] == sum(bits), f"{name}: {key}.availableCount")
        return bits

    def list_tiles(self, name, root, bits):
        self.expect(bits[0], f"{name}: its root tile is not available")
        addresses = []
        for depth in range(self.tiling["subtreeLevels"]):
            start = (4 ** depth - 1) // 3
            for morton in range(4 ** depth):
                if not bits[start + morton]:
                    continue
                address = locate(root, depth, morton)
                self.expect(address[0] < self.tiling["availableLevels"], f"{name}: tile {address} is below availableLevels")
                self.expect(depth == 0 or bits[(4 ** (depth - 1) - 1) // 3 + morton // 4], f"{name}: tile {address} has no parent")
                addresses.append(address)
        return addresses

    # ------------------------------------------------------------------ property tables

    def check_table(self, name, subtree, views, addresses):
        table = subtree["propertyTables"][subtree["tileMetadata"]]
        self.expect(table["class"] == "tile" and table["count"] == len(addresses) >= 1, f"{name}: property table")
        columns = {}
        for property_id, stored in table["properties"].items():
            if self.expect(property_id in self.properties, f"{name}: {property_id} is not in the schema"):
                columns[property_id] = self.read_column(f"{name}: {property_id}", self.properties[property_id], stored, views, len(addresses))
        for property_id, definition in self.properties.items():
            self.expect(property_id in columns or not definition.get("required"), f"{name}: required property {property_id} is missing")
        for row, address in enumerate(addresses):
            self.check_tile(name, address, {key: column[row] for key, column in columns.items()})

    def read_column(self, where, definition, stored, views, rows):
        width = SIZES[definition["componentType"]]
        code = CODES[definition["componentType"]]
        view = views[stored["values"]]
        if definition.get("array") and "count" not in definition:
            kind = stored.get("arrayOffsetType", "UINT32")
            offsets_view = views[stored["arrayOffsets"]]
            self.expect(len(offsets_view) == (rows + 1) * SIZES[kind], f"{where}: number of array offsets")
            offsets = struct.unpack(f"<{rows + 1}{CODES[kind]}", offsets_view)
            self.expect(offsets[0] == 0 and all(a <= b for a, b in zip(offsets, offsets[1:])), f"{where}: array offsets fall")
            self.expect(offsets[-1] * width == len(view), f"{where}: array offsets do not end with the values")
        else:
            self.expect("arrayOffsets" not in stored, f"{where}: array offsets without need")
            count = definition.get("count", 1) * TYPES[definition["type"]]
            offsets = [row * count for row in range(rows + 1)]
            self.expect(len(view) == offsets[-1] * width, f"{where}: {len(view)} bytes of values for {rows} tiles")
        values = struct.unpack(f"<{len(view) // width}{code}", view[:len(view) // width * width])
        if code in "fd":
            self.expect(all(math.isfinite(v) for v in values), f"{where}: not finite")
        return [values[offsets[i]:offsets[i + 1]] for i in range(rows)]

    def check_tile(self, name, address, row):
        where = f"{name}: tile {address[0]}/{address[1]}/{address[2]}"
        box = row["boundingBox"]
        self.expect(all(box[i] >= 0 if i in (3, 7, 11) else box[i] == 0 for i in range(3, 12)), f"{where}: box is not upright")
        self.expect(row["geometricError"][0] >= 0, f"{where}: negative geometric error")
        self.tiles[address] = (box, row["geometricError"][0])
        for layer, description in self.extension["layers"].items():
            self.check_layer(where, address, layer, description, row)

    def check_layer(self, where, address, layer, description, row):
        ends, decoded, errors, checksums = (row.get(layer + suffix, ()) for suffix in ("Ends", "DecodedBytes", "Errors", "Checksums"))
        self.expect(len(ends) == len(decoded) == len(errors) == len(checksums) <= 16, f"{where}: {layer} has columns of unequal length")
        entry = fill(description["uri"], address)
        size = self.sizes.get(entry, 0)
        self.expect((ends[-1] if ends else 0) == size, f"{where}: {entry} has {size} bytes, its table says {ends[-1:]}")
        self.expect(all(a < b for a, b in zip((0,) + ends, ends)), f"{where}: {layer} ends do not grow")
        self.expect(all(a >= b for a, b in zip(errors, errors[1:])) and all(e >= 0 for e in errors), f"{where}: {layer} errors grow")
        self.expect(all(d % 4 == 0 for d in decoded) and sum(decoded) <= 1 << 30, f"{where}: {layer} decoded bytes")
        description.setdefault("seen", [0, 0])
        description["seen"][0] += size
        description["seen"][1] += sum(decoded)

    # ------------------------------------------------------------------ the whole

    def check_whole(self):
        self.expect(len(self.tiles) == int(self.extension["totals"]["tiles"]), f"{len(self.tiles)} tiles, the extension says otherwise")
        self.expect(max(a[0] for a in self.tiles) + 1 == self.tiling["availableLevels"], "availableLevels is not the number of levels with tiles")
        for layer, description in self.extension["layers"].items():
            wire, decoded = description.get("seen", [0, 0])
            self.expect(wire == int(description["wireBytes"]), f"{layer}: wireBytes is not the sum of its entries ({wire})")
            self.expect(decoded == int(description["decodedBytes"]), f"{layer}: decodedBytes is not the sum of its steps ({decoded})")
        for address, (box, error) in self.tiles.items():
            if address[0] == 0:
                self.expect(inside(box, self.root_box), "the root tile leaves the root square")
                self.expect(error <= self.tileset["geometricError"], "the root tile's error is above the tileset's")
                continue
            parent_box, parent_error = self.tiles[(address[0] - 1, address[1] // 2, address[2] // 2)]
            self.expect(inside(box, parent_box), f"tile {address}: leaves its parent's box")
            self.expect(error <= parent_error, f"tile {address}: geometric error {error} is above its parent's {parent_error}")
        known = {"tileset.json", "@3dtilesIndex1@", "preview.png", self.extension["facadeDictionary"]["indexUri"],
                 self.extension["facadeDictionary"]["mapsUri"]}
        charts = self.extension.get("chartDictionary")
        if charts is not None:
            known |= {charts["indexUri"], charts["levelsUri"]}
        known |= {fill(d["uri"], a) for d in self.extension["layers"].values() for a in self.tiles}
        for name in self.sizes:
            self.expect(name in known or name.startswith("subtrees/"), f"{name}: nothing refers to it")
        listed = sum(1 for name in self.sizes if name.startswith("subtrees/"))
        self.expect(listed == self.subtrees, f"{listed} subtrees in the archive, {self.subtrees} reachable")
        greatest = max((size for name, size in self.sizes.items() if name.startswith("subtrees/")), default=0)
        stated = self.extension.get("greatestSubtreeBytes", 0)
        self.expect(stated in (0, greatest), f"greatestSubtreeBytes is {stated}, the largest subtree has {greatest}")
        index = self.extension["facadeDictionary"]
        self.expect(isinstance(index["madeUp"], bool), "facadeDictionary.madeUp is neither true nor false")
        # 9 bytes a map and 16 a level, of which a map has one to four.
        level_bytes = int(index["indexDecodedBytes"]) - 9 * int(index["count"])
        self.expect(level_bytes % 16 == 0 and int(index["count"]) <= level_bytes // 16 <= 4 * int(index["count"]),
                    "facadeDictionary: indexDecodedBytes does not fit the number of maps")
        if int(index["count"]) > 0:
            self.expect(self.sizes.get(index["indexUri"]) == int(index["indexBytes"]), "facades/index: size")
            self.expect(index["mapsUri"] in self.sizes, "facades/maps is missing")
        if charts is not None:
            # 8 bytes a chart and 4 a level, of which a chart has one to eight.
            count, level_bytes = int(charts["count"]), int(charts["indexDecodedBytes"]) - 8 * int(charts["count"])
            self.expect(level_bytes % 4 == 0 and 1 <= count <= level_bytes // 4 <= 8 * count,
                        "chartDictionary: indexDecodedBytes does not fit the number of charts")
            self.expect(self.sizes.get(charts["indexUri"]) == int(charts["indexBytes"]), "charts/index: size")
            self.expect(self.sizes.get(charts["levelsUri"]) == int(charts["levelsBytes"]), "charts/levels: size")

    def run(self):
        for step in (self.check_archive, self.check_tileset, self.check_subtrees, self.check_whole):
            try:
                step()
            except (KeyError, IndexError, ValueError, TypeError, struct.error, zipfile.BadZipFile) as reason:
                self.defects.append(f"{step.__name__}: cannot go on: {type(reason).__name__}: {reason}")
                break
        return self.defects


def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def is_size(value):
    return is_number(value) and value >= 0


def is_count(value):
    return isinstance(value, int) and not isinstance(value, bool) and value >= 0


def fill(template, address):
    level, x, y = address
    return template.replace("{level}", str(level)).replace("{x}", str(x)).replace("{y}", str(y))


def locate(root, depth, morton):
    level, x, y = root
    x, y = x << depth, y << depth
    for bit in range(depth):
        x += (morton >> (2 * bit) & 1) << bit
        y += (morton >> (2 * bit + 1) & 1) << bit
    return (level + depth, x, y)


def inside(box, outer):
    """Upright boxes, with a millimetre of room."""
    return all(outer[i] - outer[3 + 4 * i] - 1e-3 <= box[i] - box[3 + 4 * i] and box[i] + box[3 + 4 * i] <= outer[i] + outer[3 + 4 * i] + 1e-3
               for i in range(3))


def main():
    if len(sys.argv) != 2:
        print("usage: check_tileset.py ARCHIVE.3tz", file=sys.stderr)
        return 2
    try:
        checker = Checker(sys.argv[1])
    except (OSError, zipfile.BadZipFile) as reason:
        print(f"check_tileset.py: {sys.argv[1]}: {reason}", file=sys.stderr)
        return 1
    defects = checker.run()
    for defect in defects[:50]:
        print(defect)
    print(f"{sys.argv[1]}: {len(checker.sizes)} entries, {checker.subtrees} subtrees, {len(checker.tiles)} tiles, {len(defects)} defects")
    return 1 if defects else 0


if __name__ == "__main__":
    sys.exit(main())
