// Everything that programs use. What this file includes, and what those headers include in turn, is the public
// interface: it is what an installation has.
#pragma once

#include <Fulcrum/Collision/Queries/Distance.h>
#include <Fulcrum/Collision/Queries/RayCast.h>
#include <Fulcrum/Collision/Queries/ShapeCast.h>
#include <Fulcrum/Collision/Shapes/Compound.h>
#include <Fulcrum/Collision/Shapes/ConvexHull.h>
#include <Fulcrum/Collision/Shapes/CustomConvex.h>
#include <Fulcrum/Collision/Shapes/EmptyShape.h>
#include <Fulcrum/Collision/Shapes/HeightField.h>
#include <Fulcrum/Collision/Shapes/MutableCompound.h>
#include <Fulcrum/Collision/Shapes/Plane.h>
#include <Fulcrum/Collision/Shapes/Primitives.h>
#include <Fulcrum/Collision/Shapes/RoundShapes.h>
#include <Fulcrum/Collision/Shapes/SampledSurface.h>
#include <Fulcrum/Collision/Shapes/Scaled.h>
#include <Fulcrum/Collision/Shapes/ShapeFile.h>
#include <Fulcrum/Collision/Shapes/ShapeHash.h>
#include <Fulcrum/Collision/Shapes/Submersion.h>
#include <Fulcrum/Collision/Shapes/Triangle.h>
#include <Fulcrum/Collision/Shapes/TriangleMesh.h>
#include <Fulcrum/Constraints/Joints/JointDrawing.h>
#include <Fulcrum/Constraints/Joints/Path.h>
#include <Fulcrum/Jobs/JobSystem.h>
#include <Fulcrum/Jobs/ThreadPool.h>
#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Physics/Fields/Fields.h>
#include <Fulcrum/Physics/PhysicsSystem.h>
#include <Fulcrum/Physics/Ragdoll/Ragdoll.h>
#include <Fulcrum/Physics/Ragdoll/RagdollSettings.h>
#include <Fulcrum/Physics/Ragdoll/SkeletonMapping.h>
#include <Fulcrum/Physics/Ragdoll/Stabilize.h>
#include <Fulcrum/Version.h>
