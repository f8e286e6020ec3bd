package io.packcell;

/** Robots, and the items that they recognise, that an arm reaches, and that both reach. */
public record Scenario(int robots, int recognized, int accessible, int overlap) {
    /** From "S-R5A3" or "D-R5A3O1". */
    public static Scenario parse(String name) {
        Raw.pkc_scenario raw = fresh();
        Native.check(Raw.LIBRARY.pkc_scenario_parse(Native.toC(name), raw));
        return from(raw);
    }

    /** "S-R5A3" or "D-R5A3O1". */
    public String name() {
        byte[] name = new byte[32];
        Native.check(Raw.LIBRARY.pkc_scenario_name(raw(this), name, name.length));
        return Native.text(name);
    }

    static Raw.pkc_scenario fresh() {
        Raw.pkc_scenario raw = new Raw.pkc_scenario();
        Native.check(Raw.LIBRARY.pkc_scenario_init(raw, raw.size()));
        return raw;
    }

    static Scenario from(Raw.pkc_scenario raw) {
        return new Scenario(raw.robots, raw.recognized, raw.accessible, raw.overlap);
    }

    static Raw.pkc_scenario raw(Scenario scenario) {
        if (scenario == null) return null;
        Raw.pkc_scenario raw = fresh();
        raw.robots = scenario.robots;
        raw.recognized = scenario.recognized;
        raw.accessible = scenario.accessible;
        raw.overlap = scenario.overlap;
        return raw;
    }
}
