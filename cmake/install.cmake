# Install rules: headers, library, program, find_package and pkg-config files.
include(CMakePackageConfigHelpers)

set(hewer_cmake_dir ${CMAKE_INSTALL_LIBDIR}/cmake/hewer)

install(TARGETS hewer EXPORT hewerTargets
  RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR}
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS hewer_program RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(DIRECTORY include/hewer DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN "*.h")
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})

get_target_property(hewer_type hewer TYPE)
if(hewer_type STREQUAL "STATIC_LIBRARY")
  set(hewer_is_static TRUE)
else()
  set(hewer_is_static FALSE)
  file(RELATIVE_PATH hewer_bin_to_lib /${CMAKE_INSTALL_BINDIR} /${CMAKE_INSTALL_LIBDIR})
  set_target_properties(hewer_program PROPERTIES INSTALL_RPATH "$ORIGIN/${hewer_bin_to_lib}")
endif()
install(EXPORT hewerTargets NAMESPACE hewer:: DESTINATION ${hewer_cmake_dir})
configure_package_config_file(cmake/hewerConfig.cmake.in
  ${PROJECT_BINARY_DIR}/hewerConfig.cmake INSTALL_DESTINATION ${hewer_cmake_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/hewerConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/hewerConfig.cmake ${PROJECT_BINARY_DIR}/hewerConfigVersion.cmake
  DESTINATION ${hewer_cmake_dir})

# Who links a static hewer gives pkg-config --static, and gets what is inside it, too.
# Relative to the file itself, so that a moved tree or `cmake --install --prefix` still works.
file(RELATIVE_PATH hewer_pc_to_prefix /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
configure_file(cmake/hewer.pc.in ${PROJECT_BINARY_DIR}/hewer.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/hewer.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
