/** The elements of index.html that the page's code fills. */

/** The element with that id; throws if index.html has none of that kind. */
export function element<E extends Element>(id: string, kind: new () => E): E {
  const found: Element | null = document.getElementById(id);
  if (!(found instanceof kind)) throw new Error(`expected a ${kind.name} with id ${id}, got ${found?.tagName}`);
  return found;
}
