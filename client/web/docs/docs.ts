/** The REST interface as a page that runs requests, by Swagger UI: nothing of it comes from elsewhere. */

import SwaggerUI from "swagger-ui-dist/swagger-ui-es-bundle.js";
import "swagger-ui-dist/swagger-ui.css";

SwaggerUI({
  dom_id: "#requests",
  url: new URL("../openapi.json", location.href).href,
  deepLinking: true,
  defaultModelsExpandDepth: 0, // a scene is a hundred of them
  docExpansion: "list",
  displayRequestDuration: true,
  tryItOutEnabled: true,
  validatorUrl: null, // which would be told of the interface
});
