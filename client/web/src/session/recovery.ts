/** What the page does when the server has lost its session: it has it made again, from what it knows itself. */

import type { JsonObject } from "@culet/protocol/messages";
import type { Upload } from "./catalogue";
import { type Lost, ProblemError } from "./rest";

type Give = (file: File) => Promise<Upload>;

/** The files that were opened in this page, by the ids that the server gave them. */
export class OpenedFiles {
  private readonly opened = new Map<string, { file: File; give: Give }>();

  keep(id: string, file: File, give: Give): void {
    this.opened.set(id, { file, give });
  }

  /** Upload those again that a scene names; whether there were any. */
  async giveAgain(scene: JsonObject): Promise<boolean> {
    const text = JSON.stringify(scene);
    const named = [...this.opened].filter(([id]) => text.includes(JSON.stringify(id)));
    await Promise.all(named.map(([, { file, give }]) => give(file)));
    return named.length > 0;
  }
}

/** Whether a scene was refused for the file that it names: the server has not got it. */
export function lacksFile({ status, field }: ProblemError): boolean {
  return status === 422 && ["mesh", "image"].includes(field?.split(".").at(-1) ?? "");
}

/** Have a session made again, with the files that it needs; throws ProblemError if that cannot be. */
export async function recover(lost: Lost, files: OpenedFiles, reopen: (lost: Lost) => Promise<void>): Promise<void> {
  try {
    await reopen(lost);
  } catch (error) {
    if (!(error instanceof ProblemError && lacksFile(error) && (await files.giveAgain(lost.scene)))) throw error;
    await reopen(lost);
  }
}
