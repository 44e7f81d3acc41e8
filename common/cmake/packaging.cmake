# SPDX-License-Identifier: Apache-2.0
# Makes man pages from --help, then one .deb per component: cmake --build --target man, cpack --preset release.
find_program(HELP2MAN help2man)
get_property(programs GLOBAL PROPERTY CYCLORAMA_PROGRAMS)
if(HELP2MAN AND programs)
  foreach(program IN LISTS programs)
    get_property(component GLOBAL PROPERTY CYCLORAMA_COMPONENT_${program})
    set(page "${PROJECT_BINARY_DIR}/man/${program}.1.gz")
    add_custom_command(OUTPUT "${page}" DEPENDS ${program} "${CMAKE_CURRENT_LIST_DIR}/man-page"
      COMMAND "${CMAKE_CURRENT_LIST_DIR}/man-page" $<TARGET_FILE:${program}> "${PROJECT_BINARY_DIR}/man/${program}.1" VERBATIM)
    list(APPEND pages "${page}")
    install(FILES "${page}" DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT ${component} OPTIONAL)
  endforeach()
  file(MAKE_DIRECTORY "${PROJECT_BINARY_DIR}/man")
  add_custom_target(man DEPENDS ${pages})
endif()

set(CMAKE_SKIP_INSTALL_ALL_DEPENDENCY ON)  # Packages need the programs but not the tests.
set(CPACK_GENERATOR DEB)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
set(CPACK_COMPONENTS_ALL command farm node museum provision tools)
set(CPACK_PACKAGE_CONTACT "Cyclorama developers <nobody@example.org>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_DEBUGINFO_PACKAGE ON)  # Programs are stripped; their symbols are in packages of their own.
set(CPACK_DEBIAN_PACKAGE_SECTION misc)
set(CPACK_DEBIAN_COMMAND_DESCRIPTION "command line of a museum or a render host
Shows and does what the operator page does: status, doctor, calibrate, update.")
set(CPACK_DEBIAN_FARM_DESCRIPTION "render farm for projected panoramas: the coordinator
Museums and nodes connect to it. It divides each picture among the nodes so that all of
them finish at the same time, and relays what they render.")
set(CPACK_DEBIAN_NODE_DESCRIPTION "render farm for projected panoramas: a node
Ray traces for a coordinator: connects to it, fetches its scenes and renders parts of
pictures. It opens no port.")
set(CPACK_DEBIAN_MUSEUM_DESCRIPTION "visits of scenes on a projected panorama: the museum's side
Tracker, tour, display and operator page.")
set(CPACK_DEBIAN_PROVISION_DESCRIPTION "settings of a museum's computer or a render host, from a USB stick
Checks all settings and takes them into use as a whole or not at all.")
set(CPACK_DEBIAN_TOOLS_DESCRIPTION "tools for the scenes of a render farm
Render and inspect scenes, and generate a grotto for tests.")
# The maintainer scripts do what dh_installsystemd would, for the units of each package.
set(units_of_farm cyclorama-farm.service)
set(units_of_node cyclorama-node.service)
set(units_of_museum cyclorama-tour.service cyclorama-tracker.service cyclorama-display.service cyclorama-operator.service
  cyclorama-projectors.service cyclorama-hand.service cyclorama-calibrator.service)
set(units_of_provision cyclorama-settings.path)
set(settings_of_farm /etc/cyclorama/farm.toml /etc/logrotate.d/cyclorama-farm)
set(settings_of_node /etc/cyclorama/node.toml)
string(TIMESTAMP CYCLORAMA_CHANGED "%a, %d %b %Y %H:%M:%S +0000" UTC)
foreach(component IN LISTS CPACK_COMPONENTS_ALL)
  string(TOUPPER ${component} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME cyclorama-${component})
  set(extra)
  set(here "${PROJECT_BINARY_DIR}/package/${component}")
  set(doc share/doc/cyclorama-${component})
  install(FILES "${PROJECT_SOURCE_DIR}/systemd/package/copyright" DESTINATION ${doc} COMPONENT ${component})
  configure_file("${PROJECT_SOURCE_DIR}/systemd/package/changelog.in" "${here}/changelog" @ONLY)
  execute_process(COMMAND gzip -9nf "${here}/changelog" COMMAND_ERROR_IS_FATAL ANY)
  install(FILES "${here}/changelog.gz" DESTINATION ${doc} COMPONENT ${component})
  if(DEFINED units_of_${component})
    list(JOIN units_of_${component} " " UNITS)
    foreach(script postinst prerm postrm)
      configure_file("${PROJECT_SOURCE_DIR}/systemd/package/${script}.in" "${here}/${script}" @ONLY)
      list(APPEND extra "${here}/${script}")
    endforeach()
    set(CPACK_DEBIAN_${upper}_PACKAGE_DEPENDS systemd)
  endif()
  if(DEFINED settings_of_${component})
    list(JOIN settings_of_${component} "\n" lines)
    file(WRITE "${here}/conffiles" "${lines}\n")
    list(APPEND extra "${here}/conffiles")
  endif()
  set(CPACK_DEBIAN_${upper}_PACKAGE_CONTROL_EXTRA ${extra})
  set(CPACK_DEBIAN_${upper}_PACKAGE_CONTROL_STRICT_PERMISSION ON)
endforeach()
set(CPACK_DEBIAN_FARM_PACKAGE_DEPENDS "systemd, openssl, cyclorama-command")  # openssl: for cyclorama-authority.
set(CPACK_DEBIAN_NODE_PACKAGE_DEPENDS "systemd, cyclorama-command")
set(CPACK_DEBIAN_MUSEUM_PACKAGE_DEPENDS "systemd, cyclorama-command, cyclorama-provision, libgl1-mesa-dri, tzdata, fonts-dejavu-core, fonts-droid-fallback")  # The last four are opened at run time.
include(CPack)
