// Bundles src/main.ts, and the styles that it imports, into one HTML file: node build.mjs OUT.html. Beside it, the names of
// the packages that are part of it, for scripts/sbom: OUT.html.packages.json
import { readFileSync, renameSync, writeFileSync } from "node:fs";
import { build } from "esbuild";

const out = process.argv[2];
const { outputFiles, metafile } = await build({
  entryPoints: ["src/main.ts"],
  outdir: ".", // named by what is bundled; nothing is written
  bundle: true,
  minify: true,
  write: false,
  metafile: true,
  format: "iife",
  target: "es2022",
  legalComments: "eof", // licences of what is bundled stay in the page
});
const bundled = (ending) => outputFiles.find((file) => file.path.endsWith(ending)).text;

// In place of text that a browser would take for the end of the element.
const script = bundled(".js").replaceAll("</script", "<\\/script").replaceAll("<!--", "<\\!--");
const style = bundled(".css").replaceAll("</style", "<\\/style");
const html = readFileSync("template.html", "utf8")
  .replace("/*@STYLE@*/", () => style)
  .replace("/*@SCRIPT@*/", () => script);
const packages = Object.keys(metafile.inputs).flatMap(
  (file) => /^node_modules\/((?:@[^/]+\/)?[^/]+)\//.exec(file)?.[1] ?? [],
);
for (const [file, text] of [
  [`${out}.packages.json`, `${JSON.stringify([...new Set(packages)].sort())}\n`],
  [out, html],
]) {
  writeFileSync(`${file}.part`, text);
  renameSync(`${file}.part`, file);
}
