/** The words of the page, in the language that the page speaks. */

import * as english from "./english";

/** What a language has to say. */
export type Words = typeof english;

/** There is English so far. Where there are more, `navigator.languages` can choose here, before anything is shown. */
export const words: Words = english;
