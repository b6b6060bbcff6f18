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

/** What of the server a recovery needs. */
export interface Server {
  reopen: (lost: Lost) => Promise<void>;
  find: (id: string) => Promise<unknown>;
}

/**
 * Have a session made again, with the files that it needs. If its snapshot is refused, as one of a server of another
 * version, the session begins with its scene alone: better than to be lost. Whether that was done here. A page that came by a link may
 * not do that without the server's token: somebody else's page must have done it.
 *
 * Throws ProblemError if that cannot be; of status 404 if nobody else has made the session again so far.
 */
export async function recover(lost: Lost, files: OpenedFiles, server: Server): Promise<boolean> {
  try {
    await server.reopen(lost);
  } catch (error) {
    if (!(error instanceof ProblemError)) throw error;
    if (error.status === 401) {
      await server.find(lost.id);
      return false;
    }
    if (lacksFile(error)) {
      if (!(await files.giveAgain(lost.scene))) throw error;
      await server.reopen(lost);
    } else if (error.status === 422 && lost.snapshot !== null)
      return recover({ ...lost, snapshot: null }, files, server);
    else throw error;
  }
  return true;
}
