//! The keys of all fields that are read or written, in each version.
//!
//! Main type: [`WireName`]. Refuses: fields that the model has no place for.

use super::WireName;

// The header.
pub(crate) const HEADER_ID: WireName = WireName::same("headerId");
pub(crate) const TIMESTAMP: WireName = WireName::same("timestamp");
pub(crate) const VERSION: WireName = WireName::same("version");
pub(crate) const MANUFACTURER: WireName = WireName::same("manufacturer");
pub(crate) const SERIAL: WireName = WireName::same("serialNumber");

// What several messages have.
pub(crate) const X: WireName = WireName::same("x");
pub(crate) const Y: WireName = WireName::same("y");
pub(crate) const THETA: WireName = WireName::same("theta");
pub(crate) const MAP: WireName = WireName::same("mapId");
pub(crate) const NODE_ID: WireName = WireName::same("nodeId");
pub(crate) const EDGE_ID: WireName = WireName::same("edgeId");
pub(crate) const SEQUENCE: WireName = WireName::same("sequenceId");
pub(crate) const RELEASED: WireName = WireName::same("released");
pub(crate) const ORDER_ID: WireName = WireName::same("orderId");
pub(crate) const ORDER_UPDATE: WireName = WireName::same("orderUpdateId");

// Actions. The tag 2.0.0 has other keys in instant actions than its maintained branch.
pub(crate) const ACTIONS: WireName = WireName::same("actions");
pub(crate) const TAGGED_ACTIONS: WireName = WireName { by_version: [None; 3], also: &["instantActions"] };
pub(crate) const ACTION_TYPE: WireName = WireName::same("actionType").also(&["actionName"]);
pub(crate) const ACTION_ID: WireName = WireName::same("actionId");
pub(crate) const BLOCKING: WireName = WireName::same("blockingType");
pub(crate) const PARAMETERS: WireName = WireName::same("actionParameters");
pub(crate) const KEY: WireName = WireName::same("key");
pub(crate) const VALUE: WireName = WireName::same("value");
pub(crate) const RETRIABLE: WireName = WireName::since_3_0("retriable");

// Orders.
pub(crate) const NODES: WireName = WireName::same("nodes");
pub(crate) const EDGES: WireName = WireName::same("edges");
pub(crate) const NODE_POSITION: WireName = WireName::same("nodePosition");
// One key, two forms: a radius before 3.0, an ellipse since.
pub(crate) const DEVIATION_RADIUS: WireName =
    WireName::until_2_1("allowedDeviationXY").also(&["allowedDeviationXy"]);
pub(crate) const DEVIATION_ELLIPSE: WireName = WireName::since_3_0("allowedDeviationXY");
pub(crate) const ELLIPSE_A: WireName = WireName::same("a");
pub(crate) const ELLIPSE_B: WireName = WireName::same("b");
pub(crate) const DEVIATION_THETA: WireName = WireName::same("allowedDeviationTheta");
pub(crate) const START_NODE: WireName = WireName::until_2_1("startNodeId");
pub(crate) const END_NODE: WireName = WireName::until_2_1("endNodeId");
pub(crate) const EDGE_SPEED: WireName = WireName::renamed("maxSpeed", "maximumSpeed");
pub(crate) const CORRIDOR: WireName = WireName::since_2_1("corridor");
pub(crate) const LEFT_WIDTH: WireName = WireName::since_2_1("leftWidth");
pub(crate) const RIGHT_WIDTH: WireName = WireName::since_2_1("rightWidth");
pub(crate) const CORRIDOR_POINT: WireName =
    WireName { by_version: [None, Some("corridorRefPoint"), Some("corridorReferencePoint")], also: &[] };
pub(crate) const RELEASE_REQUIRED: WireName = WireName::since_3_0("releaseRequired");

// States, visualizations, connections.
pub(crate) const LAST_NODE: WireName = WireName::same("lastNodeId");
pub(crate) const LAST_SEQUENCE: WireName = WireName::same("lastNodeSequenceId");
pub(crate) const NODE_STATES: WireName = WireName::same("nodeStates");
pub(crate) const EDGE_STATES: WireName = WireName::same("edgeStates");
pub(crate) const ACTION_STATES: WireName = WireName::same("actionStates");
pub(crate) const INSTANT_ACTION_STATES: WireName = WireName::since_3_0("instantActionStates");
pub(crate) const ACTION_STATUS: WireName = WireName::same("actionStatus");
pub(crate) const ACTION_RESULT: WireName = WireName::renamed("resultDescription", "actionResult");
pub(crate) const POSITION: WireName = WireName::renamed("agvPosition", "mobileRobotPosition");
pub(crate) const LOCALIZED: WireName = WireName::renamed("positionInitialized", "localized");
pub(crate) const VELOCITY: WireName = WireName::same("velocity");
pub(crate) const VX: WireName = WireName::same("vx");
pub(crate) const VY: WireName = WireName::same("vy");
pub(crate) const OMEGA: WireName = WireName::same("omega");
pub(crate) const DRIVING: WireName = WireName::same("driving");
pub(crate) const PAUSED: WireName = WireName::same("paused");
pub(crate) const NEW_BASE: WireName = WireName::same("newBaseRequest");
pub(crate) const LOADS: WireName = WireName::same("loads");
pub(crate) const LOAD_ID: WireName = WireName::same("loadId");
pub(crate) const LOAD_TYPE: WireName = WireName::same("loadType");
pub(crate) const POWER: WireName = WireName::renamed("batteryState", "powerSupply");
pub(crate) const CHARGE: WireName = WireName::renamed("batteryCharge", "stateOfCharge");
pub(crate) const CHARGING: WireName = WireName::same("charging");
pub(crate) const MODE: WireName = WireName::same("operatingMode");
pub(crate) const ERRORS: WireName = WireName::same("errors");
pub(crate) const ERROR_TYPE: WireName = WireName::same("errorType");
pub(crate) const ERROR_LEVEL: WireName = WireName::same("errorLevel");
pub(crate) const ERROR_REFERENCES: WireName = WireName::same("errorReferences");
pub(crate) const REFERENCE_KEY: WireName = WireName::same("referenceKey");
pub(crate) const REFERENCE_VALUE: WireName = WireName::same("referenceValue");
pub(crate) const ERROR_DESCRIPTION: WireName = WireName::same("errorDescription");
pub(crate) const ERROR_HINT: WireName = WireName::since_2_1("errorHint");
pub(crate) const SAFETY: WireName = WireName::same("safetyState");
pub(crate) const E_STOP: WireName = WireName::renamed("eStop", "activeEmergencyStop");
pub(crate) const FIELD_VIOLATION: WireName = WireName::same("fieldViolation");
pub(crate) const ZONE_REQUESTS: WireName = WireName::since_3_0("zoneRequests");
pub(crate) const EDGE_REQUESTS: WireName = WireName::since_3_0("edgeRequests");
pub(crate) const REQUEST_ID: WireName = WireName::since_3_0("requestId");
pub(crate) const REQUEST_TYPE: WireName = WireName::since_3_0("requestType");
pub(crate) const REQUEST_STATUS: WireName = WireName::since_3_0("requestStatus");
pub(crate) const ZONE_SPEED: WireName = WireName::since_3_0("maximumSpeed");
pub(crate) const ZONE_ID: WireName = WireName::since_3_0("zoneId");
pub(crate) const ZONE_SET_ID: WireName = WireName::since_3_0("zoneSetId");
pub(crate) const ZONE_SETS: WireName = WireName::since_3_0("zoneSets");
pub(crate) const ZONE_SET_STATUS: WireName = WireName::since_3_0("zoneSetStatus");
pub(crate) const STATE_HEADER: WireName = WireName::since_3_0("referenceStateHeaderId");
pub(crate) const CONNECTION: WireName = WireName::same("connectionState");

// Responses and zone sets. The text of 3.0.0 calls the grant type otherwise than its schema.
pub(crate) const RESPONSES: WireName = WireName::since_3_0("responses");
pub(crate) const GRANT_TYPE: WireName = WireName::since_3_0("grantType").also(&["responseType"]);
pub(crate) const LEASE_EXPIRY: WireName = WireName::since_3_0("leaseExpiry");
pub(crate) const ZONE_SET: WireName = WireName::since_3_0("zoneSet");
pub(crate) const ZONES_OF_SET: WireName = WireName::since_3_0("zones");
pub(crate) const ZONE_TYPE: WireName = WireName::since_3_0("zoneType");
pub(crate) const VERTICES: WireName = WireName::since_3_0("vertices");
pub(crate) const RELEASE_LOSS: WireName = WireName::since_3_0("releaseLossBehavior");

// Factsheets: the type and the body.
pub(crate) const TYPE: WireName = WireName::same("typeSpecification");
pub(crate) const SERIES: WireName = WireName::same("seriesName");
pub(crate) const KINEMATICS: WireName = WireName::renamed("agvKinematic", "mobileRobotKinematics");
pub(crate) const CLASS: WireName = WireName::renamed("agvClass", "mobileRobotClass");
pub(crate) const PAYLOAD: WireName = WireName::renamed("maxLoadMass", "maximumLoadMass");
pub(crate) const LOCALIZATION: WireName = WireName::same("localizationTypes");
pub(crate) const NAVIGATION: WireName = WireName::same("navigationTypes");
pub(crate) const ZONES: WireName = WireName::since_3_0("supportedZones");
pub(crate) const BODY: WireName = WireName::same("physicalParameters");
pub(crate) const LEAST_SPEED: WireName = WireName::renamed("speedMin", "minimumSpeed");
pub(crate) const SPEED: WireName = WireName::renamed("speedMax", "maximumSpeed");
pub(crate) const ACCELERATION: WireName = WireName::renamed("accelerationMax", "maximumAcceleration");
pub(crate) const DECELERATION: WireName = WireName::renamed("decelerationMax", "maximumDeceleration");
pub(crate) const TURNING: WireName = WireName::since_3_0("maximumAngularSpeed");
pub(crate) const LEAST_HEIGHT: WireName = WireName::renamed("heightMin", "minimumHeight");
pub(crate) const HEIGHT: WireName = WireName::renamed("heightMax", "maximumHeight");
pub(crate) const WIDTH: WireName = WireName::same("width");
pub(crate) const LENGTH: WireName = WireName::same("length");

// Factsheets: limits, features and the rest.
pub(crate) const LIMITS: WireName = WireName::same("protocolLimits");
pub(crate) const TEXT_LIMITS: WireName = WireName::renamed("maxStringLens", "maximumStringLengths");
pub(crate) const ID_LENGTH: WireName = WireName::renamed("idLen", "maximumIdLength");
pub(crate) const LIST_LIMITS: WireName = WireName::renamed("maxArrayLens", "maximumArrayLengths");
pub(crate) const ORDER_NODES: WireName = WireName::same("order.nodes");
pub(crate) const TIMING: WireName = WireName::same("timing");
pub(crate) const ORDER_INTERVAL: WireName = WireName::renamed("minOrderInterval", "minimumOrderInterval");
pub(crate) const STATE_INTERVAL: WireName = WireName::renamed("minStateInterval", "minimumStateInterval");
pub(crate) const FEATURES: WireName = WireName::same("protocolFeatures");
pub(crate) const OPTIONAL_PARAMETERS: WireName = WireName::same("optionalParameters");
pub(crate) const OFFERED_ACTIONS: WireName = WireName::renamed("agvActions", "mobileRobotActions");
pub(crate) const SCOPES: WireName = WireName::same("actionScopes");
pub(crate) const PAUSE_ALLOWED: WireName = WireName::since_3_0("pauseAllowed");
pub(crate) const CANCEL_ALLOWED: WireName = WireName::since_3_0("cancelAllowed");
pub(crate) const GEOMETRY: WireName = WireName::renamed("agvGeometry", "mobileRobotGeometry");
pub(crate) const LOAD_SPECIFICATION: WireName = WireName::same("loadSpecification");
// 2.1 has `vehicleConfig`, but nothing in it that the model has.
pub(crate) const CONFIGURATION: WireName = WireName::since_3_0("mobileRobotConfiguration");
// The tag 3.0.0 has a blank in the key.
pub(crate) const BATTERY_CHARGING: WireName =
    WireName::since_3_0("batteryCharging").also(&["batteryCharging "]);
pub(crate) const CRITICAL_CHARGE: WireName = WireName::since_3_0("criticalLowChargingLevel");
