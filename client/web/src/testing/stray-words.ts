/** Words in the page's code that are not in its catalogue: for the test that keeps all words in one place. */

import { parseSync } from "vite";

interface Node {
  type: string;
  [field: string]: unknown;
}

/** Assigned, their text is seen or read out. */
const SAID = new Set(["textContent", "innerText", "title", "placeholder", "alt", "ariaLabel", "ariaDescription"]);
/** Fields of what controls and messages are made of. */
const FIELDS = new Set([
  "label",
  "title",
  "summary",
  "hint",
  "meaning",
  "textContent",
  "alt",
  "placeholder",
  "ariaLabel",
]);
/** Of the platform, which look like the beginning of a sentence: keys, and what is dropped. */
const NAMES = new Set(["Home", "End", "Escape", "Enter", "Delete", "Tab", "Key{}", "Files"]);
/** Set as attributes. */
const ATTRIBUTES = new Set(["aria-label", "aria-description", "aria-valuetext", "title", "placeholder", "alt"]);
/** Made with words. */
const CONTROLS = new Set(["Choice", "Colour", "Command", "Section", "Slider", "Toggle"]);

/** The words in a module's source that a user may see, or that look like words for one. */
export function strayWords(source: string): string[] {
  const { program, errors } = parseSync("module.ts", source);
  if (errors.length > 0) throw new Error(`expected TypeScript, got ${errors[0]?.message}`);
  const found = new Set<string>();
  visit(program as unknown as Node, false, found);
  return [...found];
}

/** `said`: what stands here is seen by users, so that every letter in it counts. */
function visit(node: Node, said: boolean, found: Set<string>): void {
  const text = textOf(node);
  if (text !== null && (said ? /\p{L}{2}/u.test(text) : looksSaid(text))) found.add(text);
  for (const [name, child] of childrenOf(node)) visit(child, isSaid(node, name, child, said), found);
}

function textOf(node: Node): string | null {
  if (node.type === "Literal") return typeof node.value === "string" ? node.value : null;
  if (node.type !== "TemplateLiteral") return null;
  return (node.quasis as { value: { cooked: string } }[]).map(({ value }) => value.cooked).join("{}");
}

/** Two words, or a sentence's beginning; what is expected is said of broken programs, by whoever mends them. */
function looksSaid(text: string): boolean {
  if (NAMES.has(text) || /^expected |^[#.[(]|\d+px |\{ /.test(text)) return false; // nor are selectors, fonts, style sheets
  return /\p{L}{2,}[,.:;]? \p{L}{2,}/u.test(text) || /^\p{Lu}\p{Ll}+[.!?\u2026:]?$/u.test(text);
}

function isSaid(node: Node, name: string, child: Node, said: boolean): boolean {
  switch (node.type) {
    case "AssignmentExpression":
      return name === "right" && SAID.has(propertyOf(node.left as Node));
    case "Property":
      return name === "value" && FIELDS.has(nameOf(node.key as Node));
    case "CallExpression": {
      const called = propertyOf(node.callee as Node);
      const [first] = node.arguments as Node[];
      if (called === "setAttribute") return child !== first && ATTRIBUTES.has(String(first?.value));
      return (
        name === "arguments" &&
        ["hint", "label", "title", "note", "notice", "problem", "finding", "tell"].includes(called)
      );
    }
    case "NewExpression":
      return child === (node.arguments as Node[])[0] && CONTROLS.has(nameOf(node.callee as Node));
    case "ConditionalExpression":
      return said && name !== "test";
    case "LogicalExpression":
    case "TemplateLiteral":
    case "ArrayExpression":
      return said;
    case "BinaryExpression":
      return said && node.operator === "+";
    default:
      return false;
  }
}

/** The last name of `a.b.c`. */
function propertyOf(node: Node): string {
  return node.type === "MemberExpression" ? nameOf(node.property as Node) : "";
}

function nameOf(node: Node): string {
  return String(node.name ?? node.value ?? "");
}

/** What users never see: types, and what modules and directives are called. */
const UNSEEN = new Set(["ImportDeclaration", "ExportAllDeclaration", "TSLiteralType", "TSTemplateLiteralType"]);

function* childrenOf(node: Node): Generator<[string, Node]> {
  for (const [name, value] of Object.entries(node)) {
    for (const child of Array.isArray(value) ? value : [value]) {
      if (isNode(child) && !UNSEEN.has(child.type)) yield [name, child];
    }
  }
}

function isNode(value: unknown): value is Node {
  return typeof value === "object" && value !== null && "type" in value && typeof value.type === "string";
}
