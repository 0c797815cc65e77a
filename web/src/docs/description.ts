// What this page reads of OpenAPI 3.1 and AsyncAPI 3.0: the parts that Giveway's descriptions use.

export interface Schema {
  $ref?: string;
  type?: string | string[];
  description?: string;
  enum?: unknown[];
  properties?: Record<string, Schema>;
  required?: string[];
  items?: Schema | boolean;
  prefixItems?: Schema[];
  oneOf?: Schema[];
  anyOf?: Schema[];
  allOf?: Schema[];
  additionalProperties?: Schema | boolean;
  minimum?: number;
  maximum?: number;
  maxLength?: number;
  minItems?: number;
  maxItems?: number;
  example?: unknown;
}

export interface Parameter {
  name: string;
  in: string;
  required?: boolean;
  description?: string;
  schema?: Schema;
}

export interface Answer {
  description: string;
  content?: Record<string, { schema?: Schema }>;
}

export interface Operation {
  operationId: string;
  summary?: string;
  description?: string;
  tags?: string[];
  parameters?: Parameter[];
  requestBody?: { content: Record<string, { schema?: Schema }> };
  responses: Record<string, Answer>;
}

export interface Description {
  info: { title: string; version: string; description?: string };
  tags?: { name: string; description?: string }[];
  paths: Record<string, Record<string, Operation>>;
  components: { schemas: Record<string, Schema> };
}

interface Ref {
  $ref: string;
}

export interface Messages {
  info: { description?: string };
  channels: Record<string, { address: string; description?: string }>;
  operations: Record<string, { action: string; channel: Ref; messages: Ref[] }>;
  components: {
    schemas: Record<string, Schema>;
    messages: Record<string, { name: string; summary?: string; payload: Schema }>;
  };
}

/** The last part of a reference. */
export function nameOf(ref: string): string {
  return ref.slice(ref.lastIndexOf('/') + 1);
}

/** One operation with its method and path. */
export interface Route {
  method: string;
  path: string;
  operation: Operation;
}

/** All operations by their first tag, in the order of the document's tags. */
export function byTag(api: Description): { tag: string; description: string; routes: Route[] }[] {
  const groups = (api.tags ?? []).map((t) => ({
    tag: t.name,
    description: t.description ?? '',
    routes: [] as Route[],
  }));
  for (const [path, item] of Object.entries(api.paths)) {
    for (const [method, operation] of Object.entries(item)) {
      const tag = operation.tags?.[0] ?? 'other';
      let group = groups.find((g) => g.tag === tag);
      if (!group) groups.push((group = { tag, description: '', routes: [] }));
      group.routes.push({ method, path, operation });
    }
  }
  return groups.filter((g) => g.routes.length > 0);
}
