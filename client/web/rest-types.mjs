// What REST answers, as TypeScript: the OpenAPI document comes on standard input, the types go to src/session/answers.ts.
// With --check the file is only compared.
import { readFileSync, writeFileSync } from "node:fs";
import { text } from "node:stream/consumers";
import { compile } from "json-schema-to-typescript";

const FILE = new URL("src/session/answers.ts", import.meta.url);
const BANNER = `// Generated from the interface's description by "make format"; do not edit.

import type { JsonObject } from "@culet/protocol/messages";
`;
/** Scenes are kept as they came, and changed by patches. */
const AS_IT_CAME = { tsType: "JsonObject" };

const { paths, components } = JSON.parse(await text(process.stdin));
const schemas = { ...components.schemas, Scene: AS_IT_CAME };

/** Names of the schemas that a part of the document refers to. */
function* named(part) {
  if (part === null || typeof part !== "object") return;
  if (typeof part.$ref === "string") yield part.$ref.split("/").at(-1);
  for (const inner of Object.values(part)) yield* named(inner);
}

/** As in a schema of an earlier draft, and without the titles of properties, which would become types of their own. */
function standing(part, key = "") {
  if (Array.isArray(part)) return part.map((inner) => standing(inner));
  if (part === null || typeof part !== "object") return part;
  if (part.type === "object" && part.additionalProperties === true && !part.properties) return AS_IT_CAME;
  const { title, prefixItems, ...kept } = part;
  if (key === "properties" && title) kept.title = title; // a property of that name
  if (prefixItems) kept.items = prefixItems;
  if (kept.$ref) kept.$ref = kept.$ref.replace("#/components/schemas/", "#/$defs/");
  return Object.fromEntries(Object.entries(kept).map(([name, value]) => [name, standing(value, name)]));
}

const answers = Object.values(paths)
  .flatMap((operations) => Object.values(operations))
  .flatMap(({ responses }) => Object.entries(responses).filter(([status]) => status.startsWith("2")));
const wanted = new Set(named(answers));
for (const name of wanted) for (const other of named(schemas[name])) wanted.add(other);
wanted.delete("Scene");
const $defs = Object.fromEntries([...wanted].sort().map((name) => [name, { ...standing(schemas[name]), title: name }]));
const compiled = await compile(
  { title: "Answers", type: "object", $defs: { ...$defs, Scene: AS_IT_CAME } },
  "Answers",
  {
    additionalProperties: false,
    bannerComment: BANNER,
    unreachableDefinitions: true,
    format: true,
    style: { printWidth: 120, bracketSpacing: true },
  },
);
const source = compiled
  .replaceAll(/( \*\n)? \* This interface was referenced by .*\n \* via the .*\n/g, "")
  .replaceAll("/**\n */\n", "")
  .replace("export interface Answers {}\n", "");
if (!process.argv.includes("--check")) writeFileSync(FILE, source);
else if (readFileSync(FILE, "utf8") !== source) {
  console.error("src/session/answers.ts is not what the interface's description gives now; run: make format");
  process.exitCode = 1;
}
