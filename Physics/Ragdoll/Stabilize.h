// Adjusts a ragdoll's masses and inertias such that few iterations hold its joints. An iterative solver converges
// slowly if a heavy part hangs on a light one, and parts with small inertia spin up under the impulses of their
// neighbors. Applied to the settings once, before the ragdoll is created. Source of the idea: O. Strunk, "Stop my
// Constraints from Blowing Up!", GDC 2013; the rules are our own. Any thread.
#pragma once

#include <Fulcrum/Physics/Ragdoll/RagdollSettings.h>

namespace fulcrum {

// Allowed ratio of a part's mass to its parent's, 0 < smallest <= largest.
struct MassRule {
    float smallest = 0.2f;
    float largest = 1.0f;
};

// From the root to the leaves, each part's mass is clamped to the rule; then all masses are scaled by a common factor
// to keep the total. Inertias scale with the masses. Parts that are not dynamic, and those whose parent is not, are
// only scaled by that factor. Errors: those of Check; of the rule NonFinite, NonPositive, OutOfRange: then nothing has
// changed.
Status StabilizeMasses(RagdollSettings& settings, const MassRule& rule = {});

struct InertiaRule {
    float principalRatio = 3.0f;  // >= 1: a part's largest principal moment over its smallest
    float childRatio = 1.0f;      // > 0: a part's largest principal moment over its parent's smallest
};

// From the leaves to the root, each part's principal moments are raised to the minimum that the rule requires; masses
// are unchanged. A raised moment only makes the part rotate more slowly under the same torque. Parts that are not
// dynamic are skipped. Errors: those of Check; for the rule NonFinite, NonPositive, OutOfRange; then nothing has
// changed.
Status StabilizeInertia(RagdollSettings& settings, const InertiaRule& rule = {});

// Mass and inertia of a body created with these settings: kg, and kg m2 about the shape's principal axes. Settings must
// be valid.
float MassOf(const BodySettings& body);
Vector3 InertiaOf(const BodySettings& body);

}  // namespace fulcrum
