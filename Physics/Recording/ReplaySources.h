// What a recording of calls names but cannot contain, because it is code of the program that was recorded. Plain data.
#pragma once

#include <Fulcrum/Collision/Shapes/ShapeFile.h>
#include <Fulcrum/Physics/ContactListener.h>
#include <Fulcrum/Physics/Snapshot.h>

#include <memory>

namespace fulcrum {

struct ReplaySources {
    List<ShapePtr> shapes{};  // custom ones that no format below writes; found by ContentHash
    List<CustomShapeFormat> customShapes{};
    // Other than GroupFilterTable; found by GroupFilter::ContentHash.
    List<std::shared_ptr<const GroupFilter>> groupFilters{};
    List<const ContactListener*> contactListeners{};  // in the order in which they were first set
    // The type of a user-defined joint, by the id that it had when it was recorded.
    Function<std::unique_ptr<JointType>(JointId joint)> makeJoint{};
};

}  // namespace fulcrum
