// The types of the page's document are those of docs/schemas/report.json, key by key: node --test document.test.mjs, in the
// folder where the page was built, with the schema's file in $SCHEMA. (tests/apps/schema_test.cpp holds what is written to
// the schema.)
import assert from "node:assert/strict";
import { existsSync, readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";
import { test } from "node:test";

// Where npm could fetch nothing there is no page, and nothing to hold to the schema.
const skip = existsSync("node_modules/typescript") ? false : "TypeScript was not fetched";
const ts = skip ? null : createRequire(join(process.cwd(), "package.json"))("typescript");
const schema = JSON.parse(readFileSync(process.env.SCHEMA, "utf8"));

const libraries = new Map();

/** The checker and the type of `name` in a file. */
function typeOf(file, name, replace = (text) => text) {
  const options = {
    strict: true,
    noEmit: true,
    lib: ["lib.es2022.d.ts"],
    target: ts.ScriptTarget.ES2022,
    moduleResolution: ts.ModuleResolutionKind.Bundler,
    module: ts.ModuleKind.ES2022,
  };
  const host = ts.createCompilerHost(options);
  const read = host.getSourceFile.bind(host);
  host.getSourceFile = (path, version) => {
    if (path === file) return ts.createSourceFile(path, replace(readFileSync(path, "utf8")), version);
    if (!libraries.has(path)) libraries.set(path, read(path, version));
    return libraries.get(path);
  };
  const program = ts.createProgram([file], options, host);
  const checker = program.getTypeChecker();
  const symbol = checker
    .getExportsOfModule(checker.getSymbolAtLocation(program.getSourceFile(file)))
    .find((s) => s.name === name);
  return { checker, type: checker.getDeclaredTypeOfSymbol(symbol), file: program.getSourceFile(file) };
}

/** Differences of a type and a schema, by place. */
class Comparison {
  differences = [];
  constructor({ checker, file }) {
    this.checker = checker;
    this.file = file;
  }
  say(place, expected, type) {
    this.differences.push(`${place}: ${expected} in the schema, ${this.checker.typeToString(type)} in the page`);
  }
  compare(type, schema, place) {
    const parts = type.isUnion() ? type.types : [type];
    const rest = parts.filter((part) => !(part.flags & (ts.TypeFlags.Null | ts.TypeFlags.Undefined)));
    const isNull = parts.some((part) => part.flags & ts.TypeFlags.Null);
    const choices = schema.anyOf ?? [schema];
    const some = choices.filter((choice) => choice.type !== "null");
    if (isNull !== some.length < choices.length) return this.say(place, isNull ? "never null" : "or null", type);
    assert.equal(some.length, 1, `${place}: one type beside null`);
    const [one] = some;
    if ("const" in one || "enum" in one) return this.compareValues(rest, one.enum ?? [one.const], type, place);
    if (one.type === "boolean")
      return this.expect(
        rest.every((part) => part.flags & ts.TypeFlags.BooleanLike),
        one.type,
        type,
        place,
      );
    if (rest.length !== 1) return this.say(place, one.type, type);
    if (one.type === "object") return this.compareObject(rest[0], one, place);
    if (one.type === "array") return this.compareArray(rest[0], one, place);
    const flag = { string: ts.TypeFlags.String, number: ts.TypeFlags.Number, integer: ts.TypeFlags.Number }[one.type];
    assert.ok(flag, `${place}: ${one.type}`);
    this.expect(rest[0].flags & flag, one.type, type, place);
  }
  expect(holds, expected, type, place) {
    if (!holds) this.say(place, expected, type);
  }
  compareValues(parts, values, type, place) {
    this.expect(
      JSON.stringify(parts.map((part) => part.value).sort()) === JSON.stringify([...values].sort()),
      values.join(" | "),
      type,
      place,
    );
  }
  compareObject(type, schema, place) {
    if (!schema.properties) return this.expect(type.getStringIndexType(), "any keys", type, place);
    const known = new Map(type.getProperties().map((property) => [property.name, property]));
    for (const [key, of] of Object.entries(schema.properties)) {
      const property = known.get(key);
      known.delete(key);
      if (!property) {
        this.differences.push(`${place}.${key}: unknown to the page`);
        continue;
      }
      const optional = Boolean(property.flags & ts.SymbolFlags.Optional);
      if (optional === (schema.required ?? []).includes(key))
        this.differences.push(`${place}.${key}: ${optional ? "required" : "optional"} in the schema alone`);
      this.compare(this.checker.getTypeOfSymbolAtLocation(property, this.file), of, `${place}.${key}`);
    }
    for (const key of known.keys()) this.differences.push(`${place}.${key}: not in the schema`);
  }
  compareArray(type, schema, place) {
    const elements = this.checker.getTypeArguments(type);
    const length = this.checker.isTupleType(type) ? elements.length : undefined;
    if (length !== (schema.maxItems ?? undefined))
      return this.say(place, `${schema.maxItems ?? "any number of"} items`, type);
    assert.ok(schema.items, `${place}: says of what`);
    elements.forEach((element, i) =>
      this.compare(element, Array.isArray(schema.items) ? schema.items[i] : schema.items, `${place}[${i}]`),
    );
  }
}

function differences(wanted, replace) {
  const found = typeOf(join(process.cwd(), "src/document.ts"), "ReportDocument", replace);
  const comparison = new Comparison(found);
  comparison.compare(found.type, wanted, "document");
  return comparison.differences;
}

test("the page's types are those of the schema", { skip }, () => {
  assert.deepEqual(differences(schema), []);
});

test("a key, a type, a value or a null that only one of them has is found", { skip }, () => {
  const planted = [
    ["x_label: string;", "", "document.charts[0].charts[0].x_label: unknown to the page"],
    [
      "x_label: string;",
      "x_label: string; z_label: string;",
      "document.charts[0].charts[0].z_label: not in the schema",
    ],
    ["x_label: string;", "x_label?: string;", "document.charts[0].charts[0].x_label: required in the schema alone"],
    ["x_log: boolean;", "x_log: number;", "document.charts[0].charts[0].x_log: boolean in the schema"],
    [
      '"dots" | "line" | "path"',
      '"dots" | "line"',
      "document.charts[0].charts[0].series[0].style: dots | line | path in the schema",
    ],
    ["tables: TableDocument[];", "tables: TableDocument[] | null;", "document.tables: never null in the schema"],
    [
      "points: [number, number][]",
      "points: [number, number, number][]",
      "document.charts[0].charts[0].series[0].points[0]: 2 items in the schema",
    ],
  ];
  for (const [from, to, expected] of planted) {
    const found = differences(schema, (text) => {
      assert.ok(text.includes(from), from);
      return text.replace(from, to);
    });
    assert.equal(found.length, 1, `${from} -> ${to}: ${found}`);
    assert.ok(found[0].startsWith(expected), `${found[0]}, not ${expected}`);
  }
});
