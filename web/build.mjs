// Bundles src/main.ts, and the styles that it imports, into one HTML file: node build.mjs OUT.html
import { readFileSync, renameSync, writeFileSync } from "node:fs";
import { build } from "esbuild";

const out = process.argv[2];
const { outputFiles } = await build({
  entryPoints: ["src/main.ts"],
  outdir: ".", // named by what is bundled; nothing is written
  bundle: true,
  minify: true,
  write: false,
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
writeFileSync(`${out}.part`, html);
renameSync(`${out}.part`, out);
