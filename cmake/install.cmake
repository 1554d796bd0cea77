# SPDX-FileCopyrightText: The Swarmflow authors
# SPDX-License-Identifier: Apache-2.0
# What `cmake --install` puts into a prefix beside the programs and missions: the public headers, the IDL, the
# static libraries and a relocatable CMake package, find_package(Swarmflow):
#
#   Swarmflow::core      geometry, Gaussians, plans, missions
#   Swarmflow::robot     drivers and control methods; run_robot()
#   Swarmflow::planning  planning methods; run_planner()
#   Swarmflow::observe   observers of a run in flight or of its recording
#   Swarmflow::bus       the bus that robot, planning and observe use, for programs that link it directly
include(CMakePackageConfigHelpers)

# swarm_export(TARGET [NAME]): the package has this target, as Swarmflow::NAME.
function(swarm_export target)
  if(ARGC GREATER 1)
    set_target_properties(${target} PROPERTIES EXPORT_NAME ${ARGV1})
  endif()
  install(TARGETS ${target} EXPORT SwarmflowTargets
          ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}/swarmflow
          INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
endfunction()

swarm_export(swarm_core core)
swarm_export(swarm_agent_process robot)
swarm_export(swarm_planner_program planning)
swarm_export(swarm_observe observe)
swarm_export(swarm_link bus)
# What those are made of; their names are not for users.
foreach(target IN ITEMS swarm_options swarm_math swarm_mission swarm_mission_file swarm_files swarm_robot_log
        swarm_shell swarm_gate swarm_agent
        swarm_agent_inbox swarm_driver_check swarm_driver_specs swarm_drivers swarm_ros swarm_planner swarm_planner_inbox
        swarm_monitor_core swarm_recording)
  swarm_export(${target})
endforeach()
if(SWARM_WITH_CYCLONEDDS)
  swarm_export(swarm_link_cyclone)
endif()

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/Swarmflow)
install(EXPORT SwarmflowTargets NAMESPACE Swarmflow:: DESTINATION ${package_dir})
configure_package_config_file(cmake/SwarmflowConfig.cmake.in SwarmflowConfig.cmake
                              INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(SwarmflowConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/SwarmflowConfig.cmake
              ${CMAKE_CURRENT_BINARY_DIR}/SwarmflowConfigVersion.cmake
        DESTINATION ${package_dir})
install(DIRECTORY include/swarmflow DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(FILES idl/swarm.idl idl/blackbox.idl DESTINATION ${CMAKE_INSTALL_DATADIR}/swarmflow/idl)
install(DIRECTORY deploy/missions DESTINATION ${CMAKE_INSTALL_DATADIR}/swarmflow)
install(DIRECTORY examples DESTINATION ${CMAKE_INSTALL_DATADIR}/swarmflow)
