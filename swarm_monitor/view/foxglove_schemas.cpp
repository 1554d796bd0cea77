// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/view/foxglove_schemas.hpp"

namespace swarm::monitor::foxglove {

/// Written by hand after Foxglove's published schemas: field order and types must match them.
const std::string_view kPosesInFrameIdl = R"(module foxglove {
struct Time { uint32 sec; uint32 nsec; };
struct Vector3 { double x; double y; double z; };
struct Quaternion { double x; double y; double z; double w; };
struct Pose { Vector3 position; Quaternion orientation; };
struct PosesInFrame {
  Time timestamp;
  string frame_id;
  sequence<Pose> poses;
};
};
)";

/// SceneUpdate needs every primitive declared, although only cylinders and lines are used.
const std::string_view kSceneUpdateIdl = R"(module foxglove {
struct Time { uint32 sec; uint32 nsec; };
struct Duration { int32 sec; uint32 nsec; };
struct Color { double r; double g; double b; double a; };
struct Vector3 { double x; double y; double z; };
struct Point3 { double x; double y; double z; };
struct Quaternion { double x; double y; double z; double w; };
struct Pose { Vector3 position; Quaternion orientation; };
struct KeyValuePair { string key; string value; };
struct ArrowPrimitive {
  Pose pose;
  double shaft_length;
  double shaft_diameter;
  double head_length;
  double head_diameter;
  Color color;
};
struct CubePrimitive { Pose pose; Vector3 size; Color color; };
struct SpherePrimitive { Pose pose; Vector3 size; Color color; };
struct CylinderPrimitive {
  Pose pose;
  Vector3 size;
  double bottom_scale;
  double top_scale;
  Color color;
};
enum LineType { LINE_STRIP, LINE_LOOP, LINE_LIST };
struct LinePrimitive {
  LineType type;
  Pose pose;
  double thickness;
  boolean scale_invariant;
  sequence<Point3> points;
  Color color;
  sequence<Color> colors;
  sequence<uint32> indices;
};
struct TriangleListPrimitive {
  Pose pose;
  sequence<Point3> points;
  Color color;
  sequence<Color> colors;
  sequence<uint32> indices;
};
struct TextPrimitive {
  Pose pose;
  boolean billboard;
  double font_size;
  boolean scale_invariant;
  Color color;
  string text;
};
struct ModelPrimitive {
  Pose pose;
  Vector3 scale;
  Color color;
  boolean override_color;
  string url;
  string media_type;
  sequence<uint8> data;
};
struct SceneEntity {
  Time timestamp;
  string frame_id;
  string id;
  Duration lifetime;
  boolean frame_locked;
  sequence<KeyValuePair> metadata;
  sequence<ArrowPrimitive> arrows;
  sequence<CubePrimitive> cubes;
  sequence<SpherePrimitive> spheres;
  sequence<CylinderPrimitive> cylinders;
  sequence<LinePrimitive> lines;
  sequence<TriangleListPrimitive> triangles;
  sequence<TextPrimitive> texts;
  sequence<ModelPrimitive> models;
};
enum SceneEntityDeletionType { MATCHING_ID, ALL };
struct SceneEntityDeletion { Time timestamp; SceneEntityDeletionType type; string id; };
struct SceneUpdate {
  sequence<SceneEntityDeletion> deletions;
  sequence<SceneEntity> entities;
};
};
)";

}  // namespace swarm::monitor::foxglove
