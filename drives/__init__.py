"""Two spools, a belt and a spring-loaded pulley (to come)."""
