// A listing of openapi.json without anything from the network: what each request takes, its errors, and a button.
const api = await (await fetch("openapi.json")).json();
const element = (name, properties = {}, ...children) => {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...children);
  return made;
};
const resolved = (schema) =>
  schema?.$ref ? schema.$ref.split("/").slice(1).reduce((at, key) => at[key], api) : (schema ?? {});

for (const [path, operations] of Object.entries(api.paths)) {
  for (const [method, operation] of Object.entries(operations)) {
    document.querySelector("main").append(listed(path, method, operation));
  }
}

function listed(path, method, operation) {
  const inputs = (operation.parameters ?? []).map((parameter) => {
    const input = element("input", { name: parameter.name, required: !!parameter.required });
    const fallback = parameter.schema?.default;
    if (fallback !== undefined) input.placeholder = fallback;
    const about = parameter.description ?? parameter.schema?.description ?? "";
    return { parameter, input, label: element("label", {}, `${parameter.name} `, input, element("small", {}, ` ${about}`)) };
  });
  const content = operation.requestBody?.content ?? {};
  const json = content["application/json"];
  const schema = resolved(json?.schema?.anyOf?.find((option) => option.$ref) ?? json?.schema);
  const body = json && element("textarea", {
    value: JSON.stringify((json.schema.examples ?? schema.examples ?? [{}])[0], null, 2),
  });
  const file = content["multipart/form-data"] && element("input", { type: "file" });
  const answer = element("div");
  const run = element("button", { type: "submit" }, "Run");
  const form = element("form", {}, ...inputs.map(({ label }) => label), ...[body, file].filter(Boolean), run);
  form.addEventListener("submit", async (event) => {
    event.preventDefault();
    run.disabled = true;
    try {
      answer.replaceChildren(...(await shown(await send())));
    } finally {
      run.disabled = false;
    }
  });

  function send() {
    const query = new URLSearchParams();
    let target = path;
    for (const { parameter, input } of inputs) {
      if (parameter.in === "path") target = target.replace(`{${parameter.name}}`, encodeURIComponent(input.value));
      else if (input.value !== "") query.set(parameter.name, input.value);
    }
    const options = { method: method.toUpperCase() };
    if (body) Object.assign(options, { body: body.value, headers: { "Content-Type": "application/json" } });
    if (file) {
      options.body = new FormData();
      if (file.files.length > 0) options.body.append("file", file.files[0]);
    }
    return fetch(`${target}${query.size > 0 ? `?${query}` : ""}`, options);
  }

  const errors = Object.keys(operation.responses).filter((status) => /^[45]/.test(status)).join(", ");
  return element("details", {},
    element("summary", {}, element("span", { className: "method" }, method.toUpperCase()), " ", element("code", {}, path)),
    element("p", {}, operation.description ?? operation.summary ?? "", errors && ` Errors: ${errors}.`),
    form, answer);
}

async function shown(response) {
  const type = response.headers.get("content-type") ?? "";
  const heading = element("p", {}, `${response.status} ${response.statusText} ${type}`);
  if (type.includes("json")) return [heading, element("pre", {}, JSON.stringify(await response.json(), null, 2))];
  if (type.startsWith("text/")) return [heading, element("pre", {}, await response.text())];
  const blob = await response.blob();
  if (blob.size === 0) return [heading];
  const link = element("a", { href: URL.createObjectURL(blob), download: "answer" }, `${blob.size} bytes, save`);
  const viewable = type === "image/png" || type === "image/jpeg";
  return [heading, link, ...(viewable ? [element("p", {}, element("img", { src: link.href, alt: "the answer" }))] : [])];
}
