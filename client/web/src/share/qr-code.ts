/** A text as a QR code, drawn as SVG. */

const SVG = "http://www.w3.org/2000/svg";
/** Modules of white around it, which readers need (ISO/IEC 18004 asks for four). */
export const BORDER = 4;

export async function qrCode(text: string): Promise<SVGSVGElement> {
  const { encode } = await import("uqr"); // loaded when somebody shares
  const { data, size } = encode(text, { ecc: "M", border: BORDER });
  const svg = document.createElementNS(SVG, "svg");
  svg.setAttribute("viewBox", `0 0 ${size} ${size}`);
  svg.setAttribute("role", "img");
  const path = document.createElementNS(SVG, "path");
  path.setAttribute("d", squares(data));
  svg.append(path);
  return svg;
}

/** One square for each dark module, as an SVG path. */
export function squares(modules: readonly (readonly boolean[])[]): string {
  return modules.flatMap((row, y) => row.map((dark, x) => (dark ? `M${x} ${y}h1v1h-1z` : ""))).join("");
}
